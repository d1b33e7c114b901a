#include "lte/scene/point_table.h"

#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/base/file.h"
#include "tests/support/temp_dir.h"

namespace lte::scene {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr const char* kHeader = "px,py,pz,nx,ny,nz\n";

class PointTables : public testing::Test {
 protected:
  PointTable read(const std::string& text) const {
    test::write_text(folder_ / "points.csv", text);
    return read_point_table(folder_ / "points.csv");
  }
  std::string error(const std::string& text) const {
    return test::error_of([&] { read(text); });
  }

  test::TempDir folder_;
};

TEST_F(PointTables, ReadsPointsAndBringsNormalsToUnitLength) {
  const PointTable points = read(concat(kHeader, "1,2,3,0,2,0\r\n-0.5,1e-3,+4, 0,0,-1\n\n"));
  ASSERT_EQ(points.lines.size(), 2u);
  EXPECT_EQ(points.position[0], (Vec3{1, 2, 3}));
  EXPECT_EQ(points.normal[0], (Vec3{0, 1, 0}));
  EXPECT_EQ(points.position[1], (Vec3{-0.5f, 1e-3f, 4}));
  EXPECT_EQ(points.normal[1], (Vec3{0, 0, -1}));
  EXPECT_EQ(points.lines[0], "1,2,3,0,2,0");
}

/// As spreadsheets and people write it.
TEST_F(PointTables, ReadsByteOrderMarksLineEndsOfWindowsAndBlanks) {
  const std::string plain = concat(kHeader, "1,2,3,0,2,0\n-0.5,1e-3,+4,0,0,-1\n");
  const PointTable expected = read(plain);
  for (const std::string& text :
       {"\xEF\xBB\xBF" + plain,
        std::string("px,py,pz,nx,ny,nz\r\n1,2,3,0,2,0\r\n-0.5,1e-3,+4,0,0,-1\r\n"),
        std::string("px, py, pz, nx, ny, nz\n1, 2, 3, 0, 2, 0\n-0.5, 1e-3, +4, 0, 0, -1"),
        std::string("\xEF\xBB\xBF px\t,py ,pz,nx,ny,nz \r\n 1 ,\t2,3,0,2,0 \r\n \r\n"
                    "-0.5,1e-3,+4,0,0,-1\r\n\r\n")}) {
    const PointTable points = read(text);
    EXPECT_EQ(points.position, expected.position) << text;
    EXPECT_EQ(points.normal, expected.normal) << text;
  }
}

TEST_F(PointTables, BadHeadersAreNamedByColumn) {
  EXPECT_THAT(error("px,py,z,nx,ny,nz\n0,0,0,0,1,0\n"),
              AllOf(HasSubstr("line 1, column 3"), HasSubstr("\"pz\""), HasSubstr("got \"z\"")));
  EXPECT_THAT(error("px;py;pz;nx;ny;nz\n0;0;0;0;1;0\n"),
              AllOf(HasSubstr("line 1, column 1"), HasSubstr("separated by commas")));
  EXPECT_THAT(error("px,py,pz,nx,ny\n"), HasSubstr("line 1, column 6"));
  EXPECT_THAT(error("px,py,pz,nx,ny,nz,r\n"), HasSubstr("line 1, column 7"));
}

TEST_F(PointTables, BadInputIsNamedByLineAndColumn) {
  const std::string good = concat(kHeader, "0,0,0,0,1,0\n");
  EXPECT_THAT(error("x,y,z,nx,ny,nz\n"),
              AllOf(HasSubstr("points.csv: line 1"), HasSubstr("px,py,pz,nx,ny,nz")));
  EXPECT_THAT(error(good + "0,0,zero,0,1,0\n"),
              AllOf(HasSubstr("line 3, column pz"), HasSubstr("\"zero\"")));
  EXPECT_THAT(error(good + "0,0,0,0,1\n"), HasSubstr("line 3, column nz: missing"));
  EXPECT_THAT(error(good + "0,0,0,0,1,0,5\n"), HasSubstr("expected 6 columns, got 7"));
  EXPECT_THAT(error(good + "0,,0,0,1,0\n"), HasSubstr("line 3, column py"));
  EXPECT_THAT(error(good + "0,nan,0,0,1,0\n"),
              AllOf(HasSubstr("line 3, column py"), HasSubstr("finite")));
  EXPECT_THAT(error(good + "1e60,0,0,0,1,0\n"),
              AllOf(HasSubstr("line 3, column px"), HasSubstr("finite")));
  for (const char* far : {"1.1e9", "-1e30"}) {
    EXPECT_THAT(error(good + "0,0," + far + ",0,1,0\n"),
                AllOf(HasSubstr("line 3, column pz"), HasSubstr("farther than 1e+09")));
  }
  EXPECT_THAT(error(good + "0,0,0,0,1e30,0\n"), AllOf(HasSubstr("line 3"), HasSubstr("normal")));
  EXPECT_THAT(error(good + "0,0,0,0,0,0\n"), AllOf(HasSubstr("line 3"), HasSubstr("normal")));
  EXPECT_THAT(error(kHeader), HasSubstr("no points"));
  EXPECT_THAT(error(""), HasSubstr("no points"));
  EXPECT_THAT(test::error_of([&] { read_point_table(folder_ / "none.csv"); }),
              HasSubstr("none.csv"));
}

TEST_F(PointTables, OutputRepeatsTheInputAndAddsTheColumns) {
  const PointTable points = read(concat(kHeader, "0.50,0,0.25,0,1.0,0\n"));
  write_point_table(folder_ / "out.csv", points,
                    {{"total", "error", "rays"}, {{1.5, double{0.03f}, 1 << 30}}});
  std::istringstream out(read_file(folder_ / "out.csv"));
  std::string header, line;
  std::getline(out, header);
  std::getline(out, line);
  EXPECT_EQ(header, "px,py,pz,nx,ny,nz,total,error,rays");
  EXPECT_EQ(line.rfind("0.50,0,0.25,0,1.0,0,1.5,", 0), 0u) << line;
  EXPECT_TRUE(line.ends_with(",1073741824")) << line;
  std::istringstream fields(line);
  std::vector<float> values;
  for (std::string field; std::getline(fields, field, ',');) values.push_back(std::stof(field));
  ASSERT_EQ(values.size(), 9u);
  EXPECT_EQ(values[7], 0.03f) << "nine digits bring a float back exactly";
}

}  // namespace
}  // namespace lte::scene
