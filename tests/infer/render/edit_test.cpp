// --edit: scripts of edits, and their frames against pictures of the scene that they lead to.
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <numeric>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "infer/render/edit_player.h"
#include "infer/render/edit_script.h"
#include "infer/render/render_command.h"
#include "lte/base/file.h"
#include "lte/base/log.h"
#include "lte/image/exr.h"
#include "lte/scene/export.h"
#include "lte/scene/load.h"
#include "tests/infer/fixture.h"
#include "tests/support/command_line.h"
#include "tests/support/folder_files.h"
#include "tests/support/scenes.h"

namespace lte::infer {
namespace {

namespace fs = std::filesystem;
using test::CommandOutcome;
using test::expect_one_line;

TEST(EditScript, ReadsTracksAndEvents) {
  const EditScript script = parse_edit_script(R"(
frames: 11
fps: 12
edits:
  - light: light0
    frames: [0, 10]
    gain: [1, 0]
    color: [[1, 1, 1], [1, 0.5, 0]]
  - instance: box
    frame: 4
    turn: 90
  - remove_instance: box#2
    frame: 6
  - add_light: {name: bulb, kind: spot, position: [1, 2, 1], intensity: [1, 2, 3], outer_cone: 60}
    frame: 2
)",
                                              "edits.yaml");
  EXPECT_EQ(script.frames, 11);
  EXPECT_EQ(script.fps, 12);
  ASSERT_EQ(script.tracks.size(), 3u);
  EXPECT_EQ(script.tracks[0].at(0), std::vector<double>{1});
  EXPECT_NEAR(script.tracks[0].at(3)[0], 0.7, 1e-12);
  EXPECT_NEAR(script.tracks[1].at(5)[1], 0.75, 1e-12);
  EXPECT_EQ(script.tracks[2].at(9), std::vector<double>{90});
  ASSERT_EQ(script.events.size(), 2u);
  EXPECT_EQ(script.events[0].frame, 2) << "in the order of frames";
  EXPECT_FLOAT_EQ(script.events[0].light.outer_cone, kPi / 3);
}

TEST(EditScript, NamesFileLineAndKeyOfWhatIsWrong) {
  const auto refused = [](const std::string& edit, const std::string& why) {
    try {
      parse_edit_script("frames: 20\nedits:\n" + edit, "edits.yaml");
      ADD_FAILURE() << why;
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), testing::StartsWith("edits.yaml:"));
      EXPECT_THAT(error.what(), testing::HasSubstr(why));
      EXPECT_THAT(error.what(), testing::Not(testing::HasSubstr("\n")));
    }
  };
  refused("  - {light: a, frames: [0, 7, 7], gain: [1, 2, 3]}", "3: frames: 7 after 7");
  refused("  - {light: a, frames: [0, 20], gain: [1, 2]}", "from 0 to 19, got");
  refused("  - {light: a, frame: 0.5, gain: 1}", "a whole number");
  refused("  - {light: a, gain: .nan}", "3: gain: expected a finite number");
  refused("  - {light: a, gain: -1}", "gain: -1: expected from 0");
  refused("  - {light: a, frames: [0, 3], gain: 1}", "gain: expected a list of 2 values");
  refused("  - {light: a, color: [1, 1]}", "color: expected 3 numbers");
  refused("  - {material: a, base_color: [1, 1, 2]}", "base_color: 2: expected from 0 to 1");
  refused("  - {instance: a, gian: 2}", "unknown key \"gian\"");
  refused("  - {light: a, gian: 2}", "did you mean \"gain\"?");
  refused("  - {light: a}", "nothing is changed");
  refused("  - {lamp: a, gain: 2}", "expected one of light, instance, material");
  refused("  - {light: a, frame: 1, frames: [1], gain: 2}", "beside frame");
  refused("  - {add_light: {position: [0, 0, 0]}}", "intensity is missing");
  refused("  - {add_light: {kind: lamp, intensity: [1, 1, 1]}}", "expected point | spot");
  refused("  - 5", "expected a map");
  EXPECT_THROW(parse_edit_script("edits: []", "edits.yaml"), Error) << "without frames";
  EXPECT_THROW(parse_edit_script("frames: 0\nedits: []", "edits.yaml"), Error);
}

TEST(EditPlayer, TurnsAndScalesAboutTheMiddleAndMovesFromThePlaceInTheFile) {
  const scene::Scene room = test::furnished_room();
  Session session(room, std::nullopt);
  const EditScript script = parse_edit_script(R"(
frames: 5
edits:
  - {instance: "box#2", frames: [0, 4], move: [[0, 0, 0], [1, 0, 0]], turn: [0, 180], scale: [1, 2]}
)",
                                              "edits.yaml");
  EditPlayer player(script, &session);
  player.go_to(0);
  const Bounds first = session.state()->instances()[2].bounds;
  EXPECT_EQ(session.state()->instances()[2].to_world.m, room.instances[2].to_world.m);
  player.go_to(4);
  const Bounds last = session.state()->instances()[2].bounds;
  EXPECT_NEAR(length(last.center() - first.center() - Vec3{1, 0, 0}), 0, 1e-5);
  EXPECT_NEAR(length(last.extent() - first.extent() * 2), 0, 1e-5) << "half a turn";
}

class EditedPictures : public testing::Test {
 protected:
  EditedPictures() : before_(fs::current_path()) {
    fs::current_path(dir_.path());
    scene::Scene room = test::furnished_room();
    scene::write_glb("room.glb", room);
    write_file("camera.json", R"({"origin": [2, 1.6, 2.8], "target": [2, 1, 0], "vfov": 70})");
    test::save_tiny_model("tiny.safetensors", {.light_input = nn::LightInput::Traced});
    write_file("edits.yaml", R"(
frames: 3
edits:
  - {instance: light0, frames: [0, 2], move: [[0, 0, 0], [0.5, -0.2, 0.5]]}
  - {material: material1, frame: 1, base_color: [0.2, 0.2, 0.9]}
)");
  }
  ~EditedPictures() override {
    fs::current_path(before_);
    set_log_level(LogLevel::Info);
  }

  static CommandOutcome render(const std::string& rest, const std::string& scene = "room.glb") {
    std::istringstream words(scene +
                             " --quiet --size 24x16 --quality draft --set denoise=off --camera "
                             "camera.json" +
                             test::network_flags("tiny.safetensors", rest) + rest);
    std::vector<std::string> arguments;
    for (std::string word; words >> word;) arguments.push_back(word);
    CLI::App app{"", "lte_render"};
    RenderRequest request;
    add_render_options(app, &request);
    return test::run_command(app, arguments, [&] { run_render(request); });
  }

  test::TempDir dir_;
  fs::path before_;
};

TEST_F(EditedPictures, TheFirstFrameIsThePictureOfTheSceneAndLaterOnesDiffer) {
  ASSERT_EQ(render("--integrator path --edit edits.yaml --out f%d.exr --json run.json").code, 0);
  ASSERT_EQ(render("--integrator path --out first.exr").code, 0);
  const auto color = [](const std::string& path) { return image::read_exr(path).pixels; };
  EXPECT_EQ(color("f0.exr"), color("first.exr"));
  EXPECT_NE(color("f1.exr"), color("f2.exr"));
  ASSERT_EQ(render("--edit edits.yaml --out n%d.exr --json run.json").code, 0);
  const auto json = nlohmann::json::parse(read_file("run.json"));
  ASSERT_EQ(json["pictures"].size(), 3u);
  EXPECT_EQ(json["pictures"][1]["edit"]["encodings"], 1);
}

TEST_F(EditedPictures, HaveNoLightOfASkyOutside) {
  test::save_tiny_model("tiny.safetensors", {.scene_points = 400, .pruned = true, .suns = true});
  const auto second = [](const std::string& flags) {
    EXPECT_EQ(render("--edit edits.yaml --output gi --json run.json --out f%d.exr " + flags).code,
              0);
    return image::read_exr("f1.exr").pixels;
  };
  const auto mean = [](const std::vector<float>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  };
  const auto culled = [] {
    return nlohmann::json::parse(read_file("run.json"))["pictures"][1]["edit"]["left_out_lights"];
  };
  const std::vector<float> dim = second("--environment 1,1,1");
  EXPECT_EQ(culled(), nlohmann::json({"environment"}));
  fs::remove("f0.exr"), fs::remove("f1.exr"), fs::remove("f2.exr");
  // Which light a sample goes to depends on the sky; how much light there is does not.
  EXPECT_NEAR(mean(second("--environment 1000,1000,1000")), mean(dim), 0.2 * mean(dim));
  fs::remove("f0.exr"), fs::remove("f1.exr"), fs::remove("f2.exr");
  // A network that sees the sky lets some of it through walls; the rays over its light do not.
  EXPECT_NEAR(mean(second("--environment 1000,1000,1000 --set prune=off")), mean(dim),
              0.2 * mean(dim));
  EXPECT_TRUE(culled().empty());
}

TEST_F(EditedPictures, LightThatComesWithAnEditIsGathered) {
  const std::string gather = "--integrator gather --set records=200 ";
  const auto color = [](const std::string& path) { return image::read_exr(path).pixels; };
  write_file("lamp.yaml", R"(
frames: 3
edits:
  - {light: light0, frame: 0, gain: 0}
  - {light: light1, frame: 0, gain: 0}
  - {add_light: {name: bulb, kind: point, position: [2, 1.5, 1], intensity: [4, 4, 4]}, frame: 1}
)");
  ASSERT_EQ(render(gather + "--edit lamp.yaml --out g%d.exr").code, 0);
  const std::vector<float> dark = color("g0.exr");
  EXPECT_EQ(std::count(dark.begin(), dark.end(), 0.0f), std::ssize(dark));
  EXPECT_NE(color("g1.exr"), dark);
  EXPECT_EQ(color("g2.exr"), color("g1.exr"));
}

TEST_F(EditedPictures, GoOnWhereTheyStopped) {
  ASSERT_EQ(render("--edit edits.yaml --out f%d.png").code, 0);
  const std::string second = read_file("f1.png"), third = read_file("f2.png");
  fs::remove("f2.png");
  expect_one_line(render("--edit edits.yaml --out f%d.png"), 1, {"f0.png", "exists", "--resume"});
  ASSERT_EQ(render("--edit edits.yaml --out f%d.png --resume").code, 0);
  EXPECT_EQ(read_file("f1.png"), second);
  EXPECT_EQ(read_file("f2.png"), third) << "the state of a frame depends on the frame alone";
  write_file("edits.yaml", read_file("edits.yaml") + "  - {light: light1, gain: 2}\n");
  fs::remove("f2.png");
  expect_one_line(render("--edit edits.yaml --out f%d.png --resume"), 1, {"another edits"});
}

TEST_F(EditedPictures, RefusesWhatCannotBe) {
  expect_one_line(render("--edit edits.yaml --out one.png"), 1, {"one.png", "%04d"});
  write_file("wrong.yaml", "frames: 2\nedits:\n  - {light: lihgt1, gain: 2}\n");
  expect_one_line(render("--edit wrong.yaml --out f%d.png"), 1,
                  {"wrong.yaml:3", "\"lihgt1\"", "did you mean"});
  write_file("sun.yaml", "frames: 2\nedits:\n  - {light: light0, position: [0, 1, 0]}\n");
  expect_one_line(render("--edit sun.yaml --out f%d.png"), 1, {"sun.yaml", "move its instance"});
  EXPECT_EQ(test::folder_files(".").size(), 6u) << "room, camera, model and three scripts";
}

}  // namespace
}  // namespace lte::infer
