// Cameras and file names of the pictures of one command line; exposure flags.
#include "infer/render/views.h"

#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "infer/render/exposure.h"
#include "infer/render/frame_io.h"
#include "tests/support/scenes.h"
#include "tests/support/temp_dir.h"

namespace lte::infer {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(PictureName, PutsNumberAndNameIn) {
  EXPECT_EQ(picture_name("a/%d.png", 7, "x"), "a/7.png");
  EXPECT_EQ(picture_name("a/%04d.png", 7, "x"), "a/0007.png");
  EXPECT_EQ(picture_name("%02d.exr", 123, "x"), "123.exr");
  EXPECT_EQ(picture_name("{name}_%d.png", 0, "living room/1"), "living_room_1_0.png");
  EXPECT_EQ(picture_name("{name}.png", 0, "../up"), "_._up.png") << "it leads to no other folder";
  EXPECT_EQ(picture_name("100%.png", 3, "x"), "100%.png");
  EXPECT_EQ(picture_name("%s%d%d.png", 3, "x"), "%s3%d.png") << "the first number alone";
}

class Views : public testing::Test {
 protected:
  Views() : scene_(test::furnished_room()), bvh_(scene_) {
    for (const char* name : {"door", "sofa", "sofa"})
      scene_.cameras.push_back({name, {1, 1, 1}, {2, 1, 1}});
  }
  std::vector<std::string> names(const std::string& camera, const std::string& out) {
    std::vector<std::string> found;
    for (const View& view : choose_views(bvh_, camera, out, 1)) found.push_back(view.out);
    return found;
  }
  std::string error(const std::string& camera, const std::string& out) {
    return test::error_of([&] { names(camera, out); });
  }

  scene::Scene scene_;
  pathtrace::Bvh bvh_;
};

TEST_F(Views, OnePictureTakesTheNameAsItStands) {
  EXPECT_THAT(names("", "a.png"), ElementsAre("a.png"));
  EXPECT_THAT(names("door", "100%d.png"), ElementsAre("100%d.png"));
  EXPECT_THAT(names("1", "a.png"), ElementsAre("a.png"));
  EXPECT_EQ(choose_views(bvh_, "", "", 1)[0].camera.name, "door") << "the first of the scene";
  EXPECT_EQ(choose_views(bvh_, "auto", "", 1)[0].camera.name, "auto");
}

TEST_F(Views, TheAutomaticCameraMovesByItsOwnSeedAlone) {
  const auto origin = [&](const char* word) {
    return choose_views(bvh_, word, "", 1)[0].camera.origin;
  };
  EXPECT_EQ(origin("auto"), origin("auto:0"));
  std::set<float> places;
  for (const char* word : {"auto:0", "auto:1", "auto:2", "auto:3"}) places.insert(origin(word).x);
  EXPECT_GT(places.size(), 1u);
  EXPECT_THAT(error("auto:one", "a.png"), HasSubstr("\"auto:one\": expected auto, or auto: and"));
}

TEST_F(Views, AllOfThemNeedNamesThatDiffer) {
  EXPECT_THAT(names("all", "f/%02d.png"), ElementsAre("f/00.png", "f/01.png", "f/02.png"));
  EXPECT_THAT(error("all", "f.png"), HasSubstr("3 pictures need a pattern: %d"));
  EXPECT_THAT(error("all", "{name}.png"), HasSubstr("sofa.png: two pictures"));
  EXPECT_THAT(names("all", "{name}%d.png"), ElementsAre("door0.png", "sofa1.png", "sofa2.png"));
  EXPECT_EQ(choose_views(bvh_, "all", "", 1).size(), 3u) << "nothing is to be written";
  scene_.cameras.resize(1);
  EXPECT_THAT(names("all", "f.png"), ElementsAre("f.png"));
}

TEST_F(Views, AFileMayHoldAList) {
  const test::TempDir folder;
  test::write_text(folder / "path.json",
                   R"([{"origin":[1,1,1],"target":[2,1,1],"vfov":40},
                       {"name":"end","origin":[1,1,2],"target":[2,1,1],"vfov":40}])");
  EXPECT_THAT(names((folder / "path.json").string(), "{name}.png"),
              ElementsAre("path_0.png", "end.png"));
}

/// Reads --set of a command line.
ExposureOptions parse(std::vector<std::string> words) {
  CLI::App app;
  ExposureOptions options;
  SetKeys keys;
  add_exposure_keys(&keys, &options);
  keys.add_to(&app);
  for (size_t i = 0; i < words.size(); i += 2)
    words.insert(words.begin() + static_cast<long>(i), "--set");
  std::reverse(words.begin(), words.end());
  app.parse(words);
  keys.read();
  return options;
}

TEST(Exposure, RefusesWhatIsNoFiniteNumberShortly) {
  for (const std::string bad : {"nan", "inf", "-inf", "1e400", "-1", "0", "2x", ""}) {
    const std::string error = test::error_of([&] { parse({"exposure=" + bad}); });
    EXPECT_THAT(error, HasSubstr("--set exposure: expected auto, first or a factor")) << bad;
    EXPECT_LT(error.size(), 120u) << error;
  }
  for (const std::string bad : {"nan", "inf", "1e9", "one"})
    EXPECT_THROW(parse({"ev=" + bad}), Error) << bad;
  EXPECT_EQ(parse({"ev=+1.5"}).ev, 1.5);
  EXPECT_EQ(parse({"ev=-2"}).ev, -2);
  EXPECT_EQ(parse({"exposure=0.25"}).exposure, 0.25);
  EXPECT_TRUE(parse({"exposure=0.25", "exposure=first"}).first) << "later ones win";
}

TEST(Exposure, StopsMultiplyTheGivenOrTheAutomaticFactor) {
  Frame frame;
  frame.color = image::Image(2, 1, 3);
  frame.color.pixels = {0.1f, 0.1f, 0.1f, 9, 9, 9};  // a surface beside a bright sky
  frame.depth = image::Image(2, 1, 1);
  frame.depth.pixels = {3, 0};
  EXPECT_NEAR(choose_exposure(frame, Output::Full, {}), 8, 1e-5);
  EXPECT_NEAR(choose_exposure(frame, Output::Full, {.ev = 1}), 16, 1e-5);
  EXPECT_NEAR(choose_exposure(frame, Output::Full, {.ev = -3}), 1, 1e-5);
  EXPECT_NEAR(choose_exposure(frame, Output::Gi, {.exposure = 0.5, .ev = 2}), 2, 1e-6);
  EXPECT_EQ(choose_exposure(frame, Output::Normal, {.exposure = 0.5, .ev = 2}), 1);
  EXPECT_TRUE(std::isfinite(choose_exposure(frame, Output::Full, {.exposure = 1e30, .ev = 100})));
}

}  // namespace
}  // namespace lte::infer
