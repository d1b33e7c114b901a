#include "datagen/commands/probe.h"

#include <cmath>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/base/file.h"
#include "lte/base/log.h"
#include "tests/data/sample_fixture.h"
#include "tests/datagen/scenes.h"

namespace lte::datagen::test {
namespace {

using data::test::error_of;
using ::testing::AllOf;
using ::testing::HasSubstr;

class Probe : public data::test::Folder {
 protected:
  void SetUp() override {
    Folder::SetUp();
    set_log_level(LogLevel::Quiet);
  }
  void TearDown() override {
    set_log_level(LogLevel::Info);
    Folder::TearDown();
  }
  ProbePoints read(const std::string& text) const {
    write_file(folder_ / "points.csv", text);
    return read_probe_points(folder_ / "points.csv");
  }
  std::string error(const std::string& text) const {
    return error_of([&] { read(text); });
  }
  /// `count` points over the floor of the furnace.
  static ProbePoints on_the_floor(int count) {
    ProbePoints points;
    for (int i = 0; i < count; ++i) {
      points.position.push_back(
          {(static_cast<float>(i) + 0.5f) / static_cast<float>(count), 0, 0.3f});
      points.normal.push_back({0, 1, 0});
      points.lines.push_back("line");
    }
    return points;
  }
};

constexpr const char* kHeader = "px,py,pz,nx,ny,nz\n";

TEST_F(Probe, ReadsPointsAndBringsNormalsToUnitLength) {
  const ProbePoints points = read(concat(kHeader, "1,2,3,0,2,0\r\n-0.5,1e-3,+4, 0,0,-1\n\n"));
  ASSERT_EQ(points.lines.size(), 2u);
  EXPECT_EQ(points.position[0], (Vec3{1, 2, 3}));
  EXPECT_EQ(points.normal[0], (Vec3{0, 1, 0}));
  EXPECT_EQ(points.position[1], (Vec3{-0.5f, 1e-3f, 4}));
  EXPECT_EQ(points.normal[1], (Vec3{0, 0, -1}));
  EXPECT_EQ(points.lines[0], "1,2,3,0,2,0");
}

/// As spreadsheets and people write it.
TEST_F(Probe, ReadsByteOrderMarksLineEndsOfWindowsAndBlanks) {
  const std::string plain = concat(kHeader, "1,2,3,0,2,0\n-0.5,1e-3,+4,0,0,-1\n");
  const ProbePoints expected = read(plain);
  for (const std::string& text :
       {"\xEF\xBB\xBF" + plain,
        std::string("px,py,pz,nx,ny,nz\r\n1,2,3,0,2,0\r\n-0.5,1e-3,+4,0,0,-1\r\n"),
        std::string("px, py, pz, nx, ny, nz\n1, 2, 3, 0, 2, 0\n-0.5, 1e-3, +4, 0, 0, -1"),
        std::string("\xEF\xBB\xBF px\t,py ,pz,nx,ny,nz \r\n 1 ,\t2,3,0,2,0 \r\n \r\n"
                    "-0.5,1e-3,+4,0,0,-1\r\n\r\n")}) {
    const ProbePoints points = read(text);
    EXPECT_EQ(points.position, expected.position) << text;
    EXPECT_EQ(points.normal, expected.normal) << text;
  }
}

TEST_F(Probe, BadHeadersAreNamedByColumn) {
  EXPECT_THAT(error("px,py,z,nx,ny,nz\n0,0,0,0,1,0\n"),
              AllOf(HasSubstr("line 1, column 3"), HasSubstr("\"pz\""), HasSubstr("got \"z\"")));
  EXPECT_THAT(error("px;py;pz;nx;ny;nz\n0;0;0;0;1;0\n"),
              AllOf(HasSubstr("line 1, column 1"), HasSubstr("separated by commas")));
  EXPECT_THAT(error("px,py,pz,nx,ny\n"), HasSubstr("line 1, column 6"));
  EXPECT_THAT(error("px,py,pz,nx,ny,nz,r\n"), HasSubstr("line 1, column 7"));
}

TEST_F(Probe, BadInputIsNamedByLineAndColumn) {
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
  EXPECT_THAT(error_of([&] { read_probe_points(folder_ / "none.csv"); }), HasSubstr("none.csv"));
}

TEST_F(Probe, FurnaceGivesTheClosedFormAndHonestErrors) {
  ProbeOptions options;
  options.max_depth = 4;
  options.rays = 256;
  const ProbePoints points = on_the_floor(64);
  const ProbeResult result = probe(furnace(3, 0.6f), points, options);
  const float total = furnace_irradiance(3, 0.6f, 0, 3), direct = furnace_irradiance(3, 0.6f, 0, 0);
  double deviation = 0, variance = 0;
  for (size_t i = 0; i < 64; ++i) {
    EXPECT_NEAR(result.total[i].x, total, 0.1f * total);
    EXPECT_NEAR(result.direct[i].y, direct, 0.1f * direct);
    EXPECT_GE(result.rays[i], 256);
    deviation += std::pow(result.total[i].z - total, 2) / 64;
    variance += std::pow(result.standard_error[i].z, 2) / 64;
  }
  // The mean squared error is what the standard errors say; over 64 points that is known to a
  // factor.
  EXPECT_GT(deviation, 0.4 * variance);
  EXPECT_LT(deviation, 2.5 * variance);
}

TEST_F(Probe, TargetErrorIsMetWithoutBias) {
  ProbeOptions options;
  options.max_depth = 4;
  options.rays = 1 << 20;
  options.target_error = 0.01;
  const ProbePoints points = on_the_floor(64);
  const ProbeResult result = probe(furnace(3, 0.6f), points, options);
  const double total = furnace_irradiance(3, 0.6f, 0, 3);
  double mean = 0;
  for (size_t i = 0; i < 64; ++i) {
    EXPECT_LT(result.rays[i], 1 << 20);
    EXPECT_NEAR(result.total[i].x, total, 6 * 0.01 * total);
    mean += result.total[i].x / 64;
  }
  EXPECT_LE(result.missed, 16);
  EXPECT_NEAR(mean, total, 5 * 0.01 * total / 8);
}

TEST_F(Probe, CapIsKeptAndMissesAreCounted) {
  ProbeOptions options;
  options.rays = 128;
  options.target_error = 1e-6;
  const ProbeResult result = probe(furnace(3, 0.6f), on_the_floor(10), options);
  EXPECT_EQ(result.missed, 10);
  for (const int64_t rays : result.rays) EXPECT_EQ(rays, 128);
}

TEST_F(Probe, TighterTargetsTakeMoreRays) {
  ProbeOptions options;
  options.rays = 1 << 20;
  options.target_error = 0.02;
  const ProbePoints points = on_the_floor(16);
  const scene::Scene scene = furnace(3, 0.6f);
  const ProbeResult loose = probe(scene, points, options);
  options.target_error = 0.005;
  const ProbeResult tight = probe(scene, points, options);
  int64_t loose_rays = 0, tight_rays = 0;
  for (size_t i = 0; i < 16; ++i) {
    loose_rays += loose.rays[i];
    tight_rays += tight.rays[i];
  }
  EXPECT_GT(tight_rays, 4 * loose_rays);
}

TEST_F(Probe, OptionsOutOfRangeAreNamed) {
  const auto error_with = [](auto change) {
    ProbeOptions options;
    change(&options);
    return error_of([&] { probe(furnace(1, 0.5f), on_the_floor(1), options); });
  };
  EXPECT_THAT(error_with([](ProbeOptions* o) { o->rays = 0; }), HasSubstr("--rays"));
  EXPECT_THAT(error_with([](ProbeOptions* o) { o->max_depth = 0; }), HasSubstr("--max-depth"));
  EXPECT_THAT(error_with([](ProbeOptions* o) { o->target_error = -1; }),
              HasSubstr("--target-error"));
}

TEST_F(Probe, OutputRepeatsTheInputAndAddsTheResult) {
  const ProbePoints points = read(concat(kHeader, "0.50,0,0.25,0,1.0,0\n"));
  ProbeResult result;
  result.total = {{1.5f, 2, 3}};
  result.direct = {{0.1f, 0.2f, 0.3f}};
  result.standard_error = {{0.01f, 0.02f, 0.03f}};
  result.rays = {256};
  write_probe_result(folder_ / "out.csv", points, result);
  std::istringstream out(read_file(folder_ / "out.csv"));
  std::string header, line;
  std::getline(out, header);
  std::getline(out, line);
  EXPECT_EQ(header,
            "px,py,pz,nx,ny,nz,total_r,total_g,total_b,direct_r,direct_g,direct_b,stderr_r,stderr_"
            "g,stderr_b,rays");
  EXPECT_EQ(line.rfind("0.50,0,0.25,0,1.0,0,1.5,2,3,", 0), 0u) << line;
  EXPECT_TRUE(line.ends_with(",256")) << line;
  std::istringstream fields(line);
  std::vector<float> values;
  for (std::string field; std::getline(fields, field, ',');) values.push_back(std::stof(field));
  ASSERT_EQ(values.size(), 16u);
  EXPECT_EQ(values[9], 0.1f) << "nine digits bring a float back exactly";
  EXPECT_EQ(values[14], 0.03f);
}

}  // namespace
}  // namespace lte::datagen::test
