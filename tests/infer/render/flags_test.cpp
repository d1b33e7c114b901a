// The command line of lte_render: a method is its own flag's alone, defaults that are spelled out
// change nothing, what would be ignored is an error, and every flag has its place in the help.
#include <algorithm>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "infer/render/render_request.h"
#include "lte/cli/cli.h"

namespace lte::infer {
namespace {

using testing::HasSubstr;

class RenderFlags : public testing::Test {
 protected:
  RenderFlags() { add_render_options(app_, &request_); }
  RenderFlags& parse(std::vector<std::string> words) {
    std::reverse(words.begin(), words.end());
    app_.parse(words);
    return *this;
  }
  RenderSettings settings(std::vector<std::string> words) {
    parse(std::move(words));
    return settings_of(request_);
  }
  std::string error(std::vector<std::string> words) {
    try {
      settings(std::move(words));
    } catch (const std::exception& error) {
      return error.what();
    }
    return "";
  }

  CLI::App app_;
  RenderRequest request_;
};

std::string config(std::vector<std::string> words) {
  CLI::App app;
  RenderRequest request;
  add_render_options(app, &request);
  std::reverse(words.begin(), words.end());
  app.parse(words);
  return config_text(app);
}

TEST_F(RenderFlags, ADefaultThatIsSpelledOutChangesNothing) {
  const std::string plain = config({"room.glb"});
  for (const std::vector<std::string>& given :
       {std::vector<std::string>{"--integrator", "gather"},
        {"--quality", "final"},
        {"--size", "512x512"},
        {"--output", "full"},
        {"--set", "denoise=on"},
        {"--set", "records=4096", "--set", "exposure=auto"},
        {"--set", "correct=on", "--set", "max_memory=0", "--set", "device=auto"}}) {
    std::vector<std::string> words = {"room.glb"};
    words.insert(words.end(), given.begin(), given.end());
    EXPECT_EQ(config(words), plain) << given[1];
  }
}

TEST_F(RenderFlags, AQualityChoosesNoMethod) {
  for (const char* integrator : {"gather", "network", "path"}) {
    for (const char* quality : {"draft", "preview", "final"}) {
      CLI::App app;
      RenderRequest request;
      add_render_options(app, &request);
      app.parse(concat("room.glb --integrator ", integrator, " --quality ", quality));
      EXPECT_EQ(enum_name(settings_of(request).method), std::string(integrator));
    }
  }
}

TEST_F(RenderFlags, AsManyPathsAreTracedAsWanted) {
  for (const int spp : {1, 255, 257, 511, 1000, 76801}) {
    const RenderSettings settings =
        this->settings({"room.glb", "--integrator", "path", "--spp", std::to_string(spp)});
    EXPECT_LE(settings.path_samples, 256);
    EXPECT_EQ(settings.max_samples, spp);
    const int64_t before = int64_t{settings.passes - 1} * settings.path_samples;
    EXPECT_LT(before, spp) << "a path is left for the last pass";
    EXPECT_LE(spp - before, settings.path_samples);
  }
}

TEST_F(RenderFlags, PathsAPixelAreSharedByTwoHalves) {
  const RenderSettings settings =
      this->settings({"room.glb", "--integrator", "path", "--spp", "64"});
  EXPECT_EQ(settings.passes * settings.path_samples, 64);
}

TEST_F(RenderFlags, ATimeHasNoNumberOfPasses) {
  const RenderSettings settings = this->settings({"room.glb", "--time", "200ms"});
  EXPECT_DOUBLE_EQ(settings.seconds, 0.2);
  EXPECT_GT(settings.passes, 1 << 20);
}

struct Ignored {
  std::vector<std::string> words;
  const char* error;
};

class IgnoredFlags : public RenderFlags, public testing::WithParamInterface<Ignored> {};

TEST_P(IgnoredFlags, AreErrors) {
  std::vector<std::string> words = {"room.glb"};
  words.insert(words.end(), GetParam().words.begin(), GetParam().words.end());
  EXPECT_THAT(error(words), HasSubstr(GetParam().error));
}

INSTANTIATE_TEST_SUITE_P(
    RenderFlags, IgnoredFlags,
    testing::Values(
        Ignored{{"--spp", "8"}, "--spp goes with --integrator path"},
        Ignored{{"--checkpoint", "m"}, "--checkpoint goes with --integrator network"},
        Ignored{{"--save-embedding", "e"}, "--save-embedding goes with --integrator network"},
        Ignored{{"--set", "scene_points=9"}, "--set scene_points goes with --integrator network"},
        Ignored{{"--integrator", "path", "--set", "records=9"}, "--set records goes with"},
        Ignored{{"--output", "depth", "--quality", "draft"}, "--quality goes with a picture of"},
        Ignored{{"--out", "a.exr", "--set", "ev=1"}, "--set ev goes with a .png"}));

TEST_F(RenderFlags, AKeyThatIsNotThereIsAnsweredWithTheNearest) {
  EXPECT_THAT(error({"room.glb", "--set", "gather_ray=4"}),
              HasSubstr("--set: unknown key \"gather_ray\"; did you mean gather_rays?"));
}

TEST_F(RenderFlags, AValueThatIsWrongIsNamed) {
  EXPECT_THAT(error({"room.glb", "--set", "gather_rays=0"}),
              HasSubstr("--set gather_rays: expected a whole number from 1 to 16384, got \"0\""));
}

TEST_F(RenderFlags, ASwitchIsOnOrOff) {
  EXPECT_THAT(error({"room.glb", "--set", "denoise=yes"}),
              HasSubstr("--set denoise: expected on or off, got \"yes\""));
}

TEST_F(RenderFlags, APictureIsNamedAfterItsScene) {
  parse({"scenes/room.v2.glb"});
  EXPECT_EQ(request_.out, "room.v2.png");
  EXPECT_TRUE(request_.named_by_scene);
}

TEST_F(RenderFlags, PicturesOfSeveralCamerasAreNumbered) {
  parse({"room.glb", "--turntable", "4"});
  EXPECT_EQ(request_.out, "room_%02d.png");
}

TEST_F(RenderFlags, AreThirtyAtMostAndHaveAPlaceInTheHelp) {
  int count = 0;
  for (const CLI::Option* option : app_.get_options()) {
    if (option->get_lnames().empty()) continue;
    ++count;
    if (option->get_lnames()[0] == "help") continue;
    EXPECT_NE(option->get_group(), "Options") << option->get_name();
  }
  EXPECT_LE(count, 30);
}

}  // namespace
}  // namespace lte::infer
