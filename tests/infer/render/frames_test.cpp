// Many pictures of one command line: turntables, frames that exist, runs that go on.
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "infer/eval/flicker_command.h"
#include "infer/render/frame_set.h"
#include "infer/render/render_command.h"
#include "infer/renderer/embedding_flags.h"
#include "lte/base/file.h"
#include "lte/scene/export.h"
#include "tests/infer/fixture.h"
#include "tests/support/command_line.h"
#include "tests/support/folder_files.h"
#include "tests/support/in_folder.h"
#include "tests/support/scenes.h"

namespace lte::infer {
namespace {

namespace fs = std::filesystem;
using test::CommandOutcome;
using test::expect_one_line;
using test::folder_files;

class Frames : public test::InFolder {
 protected:
  Frames() {
    scene::Scene room = test::furnished_room();
    room.cameras.push_back({"a", {2, 1.6f, 2.8f}, {2, 1, 0}, {0, 1, 0}, 70});
    room.cameras.push_back({"b", {1, 1.6f, 2.8f}, {2, 1, 0}, {0, 1, 0}, 70});
    scene::write_glb("room.glb", room);
    room.materials[0].base_color = {0.2f, 0.2f, 0.2f};
    scene::write_glb("dark.glb", room);
    test::save_tiny_model("tiny.safetensors", {.light_input = nn::LightInput::Traced});
    test::save_tiny_model("other.safetensors", {.light_input = nn::LightInput::Traced, .seed = 2});
    fs::create_directory("f");
  }
  static CommandOutcome render(const std::string& rest, const std::string& scene = "room.glb",
                               const std::string& model = "tiny.safetensors") {
    const std::vector<std::string> arguments =
        split(scene + " --quiet --size 24x16" +
              (rest.find("--output depth") == std::string::npos ? " --quality draft" : "") +
              test::network_flags(model, rest) + rest);
    CLI::App app{"", "lte_render"};
    RenderRequest request;
    add_render_options(app, &request);
    return test::run_command(app, arguments, [&] { run_render(request); });
  }
  static std::string bytes(const std::string& path) { return read_file(path); }
  static nlohmann::json json(const std::string& path) {
    return nlohmann::json::parse(read_file(path));
  }
};

TEST_F(Frames, ATurntableWritesItsFramesUnderOneExposure) {
  ASSERT_EQ(render("--turntable 3 --camera a --out f/%02d.png --json t.json").code, 0);
  const nlohmann::json pictures = json("t.json").at("pictures");
  ASSERT_EQ(pictures.size(), 3u);
  for (size_t i = 0; i < 3; ++i) {
    EXPECT_TRUE(fs::exists("f/0" + std::to_string(i) + ".png"));
    EXPECT_EQ(pictures[i]["exposure"], pictures[0]["exposure"]);
  }
  EXPECT_NE(bytes("f/00.png"), bytes("f/01.png"));
  // The first is the picture of the camera that it begins with.
  ASSERT_EQ(render("--camera a --out one.png").code, 0);
  EXPECT_EQ(bytes("one.png"), bytes("f/00.png"));
  EXPECT_TRUE(fs::exists("f/frames_png.json"));
  ASSERT_EQ(render("--camera all --out f/{name}.png --json all.json").code, 0);
  EXPECT_NE(json("all.json").at("pictures")[0]["exposure"],
            json("all.json").at("pictures")[1]["exposure"]);
}

TEST_F(Frames, AListOfOneCameraIsAListToo) {
  test::write_text("list.json", R"([{"origin":[2,1.6,2.8],"target":[2,1,0],"vfov":70}])");
  ASSERT_EQ(render("--camera list.json --out f/%04d.png").code, 0);
  EXPECT_TRUE(fs::exists("f/0000.png"));
  test::write_text("none.json", "[]");
  expect_one_line(render("--camera none.json --out f/n%d.png"), 1, {"none.json", "got 0"});
}

TEST_F(Frames, FramesThatExistAreRefusedAndResumed) {
  ASSERT_EQ(render("--turntable 3 --out f/%d.png").code, 0);
  const std::string last = bytes("f/2.png");
  const auto before = folder_files("f");
  expect_one_line(render("--turntable 3 --out f/%d.png"), 1,
                  {"f/0.png: exists, and 2 more", "--resume"});
  EXPECT_EQ(folder_files("f"), before);

  fs::remove("f/2.png");
  fs::remove("f/0.png");
  const std::string middle = bytes("f/1.png");
  const auto written = fs::last_write_time("f/1.png");
  ASSERT_EQ(render("--turntable 3 --out f/%d.png --resume --json r.json").code, 0);
  EXPECT_EQ(folder_files("f"), before) << "the same bytes as in one go, exposure included";
  EXPECT_EQ(fs::last_write_time("f/1.png"), written) << "what is finished is not touched";
  EXPECT_EQ(json("r.json").at("pictures").size(), 2u);
  EXPECT_EQ(render("--turntable 3 --out f/%d.png --resume").code, 0) << "nothing is left to do";
  EXPECT_EQ(folder_files("f"), before);
}

TEST_F(Frames, NoMixtureOfSettingsIsMade) {
  ASSERT_EQ(render("--camera all --out f/%d.png").code, 0);
  fs::remove("f/1.png");
  const auto before = folder_files("f");
  const auto refused = [&](const CommandOutcome& run, const std::vector<std::string>& words) {
    expect_one_line(run, 1, words);
    EXPECT_EQ(folder_files("f"), before);
  };
  const std::string resume = "--camera all --out f/%d.png --resume ";
  refused(render(resume + "--seed 7"), {"f/frames_png.json", "another --seed: 0", "is 7"});
  refused(render(resume + "--output gi"), {"another --output"});
  refused(render(resume, "dark.glb"), {"another scene materials"});
  refused(render(resume, "room.glb", "other.safetensors"), {"another model"});
  refused(render("--turntable 2 --camera b --set exposure=first --out f/%d.png --resume"),
          {"another --set"});
  refused(render("--turntable 2 --camera b --out f/%d.png --resume"),
          {"f/0.png", "another camera"});
  fs::rename("f/frames_png.json", "gone.json");
  expect_one_line(render(resume), 1, {"f/0.png: exists, but not f/frames_png.json"});
  test::write_text("f/frames_png.json", "{\"format\": ");
  expect_one_line(render(resume), 1, {"f/frames_png.json: not valid JSON"});
  fs::rename("gone.json", "f/frames_png.json");
  EXPECT_EQ(render(resume + "--threads 2").code, 0) << "threads are no setting of a picture";
}

TEST_F(Frames, FlagsThatDoNotGoTogetherAreOneLine) {
  const auto before = folder_files(".");
  expect_one_line(render("--camera a --out a.png --resume"), 1, {"--resume"});
  expect_one_line(render("--turntable 3 --out a.png"), 1, {"a.png", "%d"});
  expect_one_line(render("--turntable 3 --camera all --out f/%d.png"), 1,
                  {"--turntable", "names 2"});
  test::write_text("away.json", R"({"origin":[50,1,1],"target":[60,1,1],"vfov":40})");
  expect_one_line(render("--camera away.json --out a.png"), 1, {"camera 0", "in its view"});
  fs::remove("away.json");
  EXPECT_EQ(folder_files("."), before);
}

TEST_F(Frames, AnEmbeddingFromAFileMakesTheSamePictureAndSkipsTheWork) {
  ASSERT_EQ(render("--camera a --out made.exr --save-embedding room.emb").code, 0);
  ASSERT_EQ(render("--camera a --out read.exr --embedding room.emb --json read.json").code, 0);
  EXPECT_EQ(bytes("made.exr"), bytes("read.exr"));
  const nlohmann::json seconds = json("read.json").at("seconds");
  EXPECT_EQ(seconds.at("sample"), 0);
  EXPECT_EQ(seconds.at("light"), 0);
  // Cameras are free, as is all that does not change the points.
  EXPECT_EQ(render("--camera b --embedding room.emb --out b.png").code, 0);
}

TEST_F(Frames, AnotherEmbeddingIsRefusedByWhatDiffers) {
  ASSERT_EQ(render("--camera a --out made.png --save-embedding room.emb").code, 0);
  const auto before = folder_files(".");
  const std::string use = "--camera a --out x.png --embedding room.emb ";
  const auto refused = [&](const CommandOutcome& run, const std::vector<std::string>& words) {
    expect_one_line(run, 1, words);
    EXPECT_EQ(folder_files("."), before);
  };
  refused(render(use, "dark.glb"), {"room.emb", "another scene materials"});
  refused(render(use + "--add-light 1,1,1,5"), {"another scene lights"});
  refused(render(use, "room.glb", "other.safetensors"), {"another model"});
  CommandOutcome bf16 = render(use + "--set precision=bf16");
  bf16.err.erase(0, bf16.err.find("lte_render: "));  // some processors draw a warning first
  refused(bf16, {"another precision", "bf16"});
  refused(render(use + "--set scene_points=200"), {"another scene-points: 300", "200"});
  refused(render(use + "--seed 4"), {"another seed"});
  refused(render(use + "--set prune=on"), {"another prune"});
  refused(render("--camera a --out x.png --embedding tiny.safetensors"), {"not an embedding"});
  refused(render("--camera a --out x.png --embedding none.emb"), {"none.emb"});
  refused(render(use + "--output depth"), {"--integrator", "picture of light"});
  refused(render("--camera a --out x.png --save-embedding room.glb"),
          {"--save-embedding", "SCENE"});
  EXPECT_EQ(render(use + "--save-embedding y.emb").code, 2) << "they exclude each other";
}

TEST_F(Frames, FlickerIsMeasuredOnTheFramesOfARender) {
  ASSERT_EQ(
      render(
          "--turntable 24 --camera a --output irradiance --set scene_points=100 --out f/%02d.exr")
          .code,
      0);
  FlickerRequest request;
  for (int i = 0; i < 4; ++i) request.frames.push_back("f/0" + std::to_string(i) + ".exr");
  CommonOptions common;
  common.json = "flicker.json";
  run_flicker(request, common);
  const nlohmann::json result = json("flicker.json");
  EXPECT_EQ(result.at("pairs").size(), 3u);
  EXPECT_GT(result.at("compared").get<double>(), 0.2 * result.at("pixels").get<double>());
  EXPECT_GT(result.at("change").get<double>(), 0);
  EXPECT_LT(result.at("change").get<double>(), 1) << "answers belong to points, not to views";
  request.reference = request.frames;
  run_flicker(request, common);
  EXPECT_EQ(json("flicker.json").at("excess"), 0);
  request.frames.pop_back();
  EXPECT_THAT(test::error_of([&] { run_flicker(request, common); }),
              testing::HasSubstr("one each"));
  request = {{"room.glb", "room.glb"}, {}, ""};
  EXPECT_THAT(test::error_of([&] { run_flicker(request, common); }),
              testing::HasSubstr("room.glb"));
}

TEST(FrameSets, TheManifestIsNamedAfterThePattern) {
  const auto name = [](const std::string& pattern) {
    return FrameSet(pattern, {}).manifest().string();
  };
  EXPECT_EQ(name("f/%04d.png"), "f/frames_png.json");
  EXPECT_EQ(name("f/%02d_{name}.exr"), "f/frames_exr.json");
  EXPECT_EQ(name("room_%d.png"), "room_frames_png.json");
  EXPECT_EQ(name("f/{name}/%d.png"), "f/frames_png.json");
}

}  // namespace
}  // namespace lte::infer
