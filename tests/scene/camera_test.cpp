// Camera files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/scene/load_camera.h"
#include "tests/support/temp_dir.h"

namespace lte::scene {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class LoadCamera : public ::testing::Test {
 protected:
  std::string error(const std::string& text) {
    test::write_text(dir_ / "view.json", text);
    return test::error_of([&] { load_camera(dir_ / "view.json"); });
  }

  test::TempDir dir_;
};

TEST_F(LoadCamera, ReadsItsFourKeys) {
  test::write_text(dir_ / "view.json",
                   R"({"origin":[1,2,3.5],"target":[0,0,0],"up":[0,0,1],"vfov":50})");
  const Camera camera = load_camera(dir_ / "view.json");
  EXPECT_EQ(camera.name, "view");
  EXPECT_EQ(camera.origin, (Vec3{1, 2, 3.5f}));
  EXPECT_EQ(camera.target, (Vec3{0, 0, 0}));
  EXPECT_EQ(camera.up, (Vec3{0, 0, 1}));
  EXPECT_EQ(camera.vfov, 50);
}

TEST_F(LoadCamera, NamesFileAndKeyOfEveryError) {
  const auto expect = [&](const std::string& text, const std::string& part) {
    EXPECT_THAT(error(text), AllOf(HasSubstr("view.json"), HasSubstr(part))) << text;
  };
  expect(R"({"origin":[1,2,3],"target":[0,0,0],"up":[0,0,1],"vfow":50})", "did you mean \"vfov\"");
  expect(R"({"origin":[1,2,3],"target":[0,0,0],"up":[0,0,1]})", "\"vfov\" is missing");
  expect(R"({"target":[0,0,0],"up":[0,0,1],"vfov":50})", "\"origin\" is missing");
  expect(R"({"origin":[1,2],"target":[0,0,0],"up":[0,0,1],"vfov":50})",
         "\"origin\" must be an array of 3");
  expect(R"({"origin":[1,2,3],"target":[0,"x",0],"up":[0,0,1],"vfov":50})",
         "\"target\" must be a finite number");
  expect(R"({"origin":[1,2,3],"target":[0,1e39,0],"up":[0,0,1],"vfov":50})",
         "\"target\" must be a finite number");
  expect(R"({"origin":[1,2,3],"target":[1,2,3],"up":[0,0,1],"vfov":50})",
         "must differ from \"origin\"");
  expect(R"({"origin":[0,1.1e9,0],"target":[0,0,0],"up":[0,0,1],"vfov":50})",
         "\"origin\" must have numbers of at most 1e+09");
  expect(R"({"origin":[0,0,0],"target":[0,-1e30,0],"up":[0,0,1],"vfov":50})",
         "\"target\" must have numbers of at most 1e+09");
  expect(R"({"origin":[0,0,0],"target":[0,0,2],"up":[0,1e38,0],"vfov":50})",
         "\"up\" must have numbers of at most 1e+09");
  expect(R"({"origin":[0,0,0],"target":[0,0,2],"up":[0,0,-1],"vfov":50})", "\"up\"");
  expect(R"({"origin":[0,0,0],"target":[0,0,2],"up":[0,0,0],"vfov":50})", "\"up\"");
  expect(R"({"origin":[1,2,3],"target":[0,0,0],"up":[0,0,1],"vfov":0})",
         "\"vfov\" must be between 0 and 180");
  expect(R"({"origin":[1,2,3],"target":[0,0,0],"up":[0,0,1],"vfov":180})",
         "\"vfov\" must be between 0 and 180");
  expect(R"({"origin":[1,2,3)", "not valid JSON");
  expect("[1]", "expected {");
}

TEST_F(LoadCamera, NamesAMissingFile) {
  EXPECT_THAT(test::error_of([&] { load_camera(dir_ / "none.json"); }), HasSubstr("none.json"));
}

}  // namespace
}  // namespace lte::scene
