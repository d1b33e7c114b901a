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

TEST_F(LoadCamera, UpIsOptional) {
  const auto up = [&](const std::string& target) {
    test::write_text(dir_ / "view.json", R"({"origin":[1,1,1],"vfov":50,"target":)" + target + "}");
    return load_camera(dir_ / "view.json").up;
  };
  EXPECT_EQ(up("[5,2,1]"), (Vec3{0, 1, 0}));
  EXPECT_EQ(up("[1,-3,1]"), (Vec3{0, 0, -1})) << "straight down, as on a map";
  EXPECT_EQ(up("[1,9,1]"), (Vec3{0, 0, 1})) << "straight up";
}

TEST_F(LoadCamera, ReadsBackWhatIsWritten) {
  const Camera camera{
      "front \"door\"", {1.6f, 1 / 3.0f, -2e-7f}, {4, 5, 6}, {0, 0, 1}, 39.3f, true};
  test::write_text(dir_ / "view.json", camera_json(camera));
  const Camera again = load_camera(dir_ / "view.json");
  EXPECT_EQ(again.name, camera.name);
  EXPECT_EQ(again.origin, camera.origin);
  EXPECT_EQ(again.target, camera.target);
  EXPECT_EQ(again.up, camera.up);
  EXPECT_EQ(again.vfov, camera.vfov);
  EXPECT_TRUE(again.mirrored);
  EXPECT_THAT(camera_json(camera), HasSubstr("[1.6,0.33333334,")) << "as short as it may be";
}

TEST_F(LoadCamera, ReadsListsAndTheResultsOfTheTools) {
  const std::string one = R"({"name":"a","origin":[1,2,3],"target":[0,0,0],"vfov":50})";
  const auto count = [&](const std::string& text) {
    test::write_text(dir_ / "view.json", text);
    return load_cameras(dir_ / "view.json").size();
  };
  EXPECT_EQ(count("[" + one + "," + one + "]"), 2u);
  EXPECT_EQ(count(R"({"kind":"scene","camera_list":[)" + one + "]}"), 1u);
  EXPECT_EQ(count(R"({"exposure":1,"camera":)" + one + "}"), 1u);
  EXPECT_THAT(error("[" + one + "," + one + "]"), HasSubstr("expected one camera, got 2"));
  EXPECT_THAT(error("[" + one + R"(,{"origin":[0,0,0]}])"), HasSubstr("camera 1: key \"target\""));
  EXPECT_THAT(error("[]"), HasSubstr("got 0"));
  EXPECT_THAT(error(R"({"origin":[1,2,3],"target":[0,0,0],"vfov":50,"name":7})"),
              HasSubstr("\"name\" must be a text"));
  EXPECT_THAT(error(R"({"origin":[1,2,3],"target":[0,0,0],"vfov":50,"mirrored":1})"),
              HasSubstr("\"mirrored\" must be true or false"));
}

class FindCameras : public LoadCamera {
 protected:
  FindCameras() {
    for (const char* name : {"kitchen", "hall", "hall", "3"})
      scene_.cameras.push_back({name, {0, 0, 0}, {1, 0, 0}});
    for (size_t i = 0; i < 4; ++i) scene_.cameras[i].vfov = 40 + static_cast<float>(i);
  }
  /// vfov of the one camera of a word.
  float found(const std::string& word) {
    const auto choice = find_cameras(scene_, word);
    return choice && choice->cameras.size() == 1 ? choice->cameras[0].vfov : -1;
  }
  std::string refusal(const std::string& word) {
    return test::error_of([&] { find_cameras(scene_, word); });
  }
  Scene scene_;
};

TEST_F(FindCameras, ByNameByIndexAllAndFromAFile) {
  EXPECT_EQ(found("kitchen"), 40);
  EXPECT_EQ(found("0"), 40);
  EXPECT_EQ(found("2"), 42);
  EXPECT_EQ(found("3"), 43) << "a name comes before an index";
  EXPECT_FALSE(find_cameras(scene_, "auto").has_value());
  EXPECT_EQ(find_cameras(scene_, "all")->cameras.size(), 4u);
  EXPECT_TRUE(find_cameras(scene_, "all")->several);
  test::write_text(dir_ / "view.txt", R"({"origin":[1,2,3],"target":[0,0,0],"vfov":55})");
  EXPECT_EQ(found((dir_ / "view.txt").string()), 55);
}

TEST_F(FindCameras, UnknownOnesAreAnsweredWithTheList) {
  EXPECT_THAT(refusal("kitchn"), AllOf(HasSubstr("the scene's are 0 \"kitchen\", 1 \"hall\""),
                                       HasSubstr("did you mean \"kitchen\"")));
  EXPECT_THAT(refusal("4"), HasSubstr("0 \"kitchen\""));
  EXPECT_THAT(refusal("-1"), HasSubstr("0 \"kitchen\""));
  EXPECT_THAT(refusal("hall"), AllOf(HasSubstr("2 cameras"), HasSubstr("index, such as 1")));
  EXPECT_THAT(refusal((dir_ / "none.json").string()), HasSubstr("none.json"));
  scene_.cameras.clear();
  EXPECT_THAT(refusal("0"), HasSubstr("the scene has no cameras"));
  EXPECT_THAT(refusal("all"), HasSubstr("auto makes one"));
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
