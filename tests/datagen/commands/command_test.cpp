// The built tool from outside: exit codes, one-line messages, and what a kill leaves behind.
#include <array>
#include <csignal>
#include <cstdio>
#include <map>
#include <numbers>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>

#include "lte/base/file.h"
#include "lte/data/dataset.h"
#include "lte/scene/export.h"
#include "lte/scene/load.h"
#include "tests/data/sample_fixture.h"
#include "tests/datagen/scenes.h"
#include "tests/support/folder_files.h"

namespace lte::datagen::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

struct Outcome {
  int code = -1;
  std::string output, error;
};

class Command : public data::test::Folder {
 protected:
  void SetUp() override {
    write_file(folder_ / "tiny.yaml", to_yaml(tiny_config()));
    scene::write_glb(folder_ / "box.glb", furnace(2, 0.5f));
  }

  /// Runs `lte_datagen <arguments>` in the test's folder.
  Outcome run(const std::string& arguments, const std::string& before = "") const {
    const std::string line = concat("cd '", folder_.string(), "' && ", before, "'", LTE_BINARY_DIR,
                                    "/bin/lte_datagen' ", arguments, " > out.txt 2> err.txt");
    const int status = std::system(line.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read_file(folder_ / "out.txt"),
            read_file(folder_ / "err.txt")};
  }

  /// Expects the exit code and one line on standard error that holds `part`.
  void expect_failure(int code, const std::string& part, const Outcome& outcome) const {
    EXPECT_EQ(outcome.code, code) << outcome.error;
    EXPECT_THAT(outcome.error, AllOf(HasSubstr("lte_datagen: "), HasSubstr(part)));
    EXPECT_EQ(std::count(outcome.error.begin(), outcome.error.end(), '\n'), 1) << outcome.error;
  }

  std::map<std::string, std::string> files(const std::string& out) const {
    return lte::test::folder_files(folder_ / out);
  }
};

TEST_F(Command, HelpAndVersionSucceedAndHelpHasExamples) {
  EXPECT_THAT(run("--version").output, HasSubstr("lte_datagen 0."));
  for (const char* command : {"", "generate", "bake", "probe", "info"}) {
    const Outcome outcome = run(concat(command, " --help"));
    EXPECT_EQ(outcome.code, 0);
    EXPECT_THAT(outcome.output, HasSubstr(*command ? "Examples:" : "generate --help")) << command;
  }
}

TEST_F(Command, GeneratesHomesFromTheShippedConfig) {
  const Outcome outcome = run(concat(
      "generate --config '", LTE_SOURCE_DIR,
      "/configs/data/homes.yaml' --out homes --scenes 2 --glb "
      "--set rays=4 --set scene_points=256 --set query_points=128 --set views.count=0 "
      "--set path_tracing_64=false --set 'homes.rooms=[1, 2]' --set 'homes.detail=[0.4, 0.4]' "
      "--set 'homes.texture_sizes=[16]'"));
  ASSERT_EQ(outcome.code, 0) << outcome.error;
  EXPECT_EQ(data::read_dataset_info(folder_ / "homes").scenes.size(), 2u);
  EXPECT_EQ(run("info homes --deep").code, 0);
  for (const char* name : {"home_00000", "home_00001"}) {
    const scene::Scene home =
        scene::load_scene(folder_ / "homes" / "scenes" / concat(name, ".glb"));
    EXPECT_GT(home.triangle_count(), 2000);
    EXPECT_FALSE(home.cameras.empty());
    EXPECT_TRUE(home.ignored.empty());
    const data::SceneSample sample =
        data::read_scene_sample(folder_ / "homes" / "scenes" / concat(name, ".safetensors"));
    EXPECT_EQ(sample.light_groups, static_cast<int64_t>(home.light_groups.size()));
  }
}

TEST_F(Command, WrongUsageExitsWithTwo) {
  EXPECT_EQ(run("").code, 2);
  expect_failure(2, "unknown command \"bakery\"", run("bakery"));
  expect_failure(2, "the commands are generate, bake, probe, info", run("nonsense"));
  expect_failure(2, "the commands are generate, bake, probe, info", run("nonsense --help"));
  EXPECT_EQ(run("nonsense --help").output, "");
  EXPECT_EQ(run("bake").code, 2);
  EXPECT_EQ(run("generate --out x").code, 2);
  EXPECT_EQ(run("generate --config tiny.yaml --out x --merge").code, 2);
  EXPECT_EQ(run("bake box.glb --out x.safetensors --rays many").code, 2);
  EXPECT_THAT(run("bake box.glb --outt x.safetensors").error, HasSubstr("--out"));
}

TEST_F(Command, GenerateMakesADatasetAndReportsIt) {
  const Outcome outcome =
      run("generate --config tiny.yaml --out boxes --scenes 2 --json r.json --quiet --glb");
  EXPECT_EQ(outcome.code, 0) << outcome.error;
  EXPECT_EQ(outcome.error, "");
  EXPECT_EQ(nlohmann::json::parse(read_file(folder_ / "r.json"))["baked"], 2);
  EXPECT_EQ(data::read_dataset_info(folder_ / "boxes").scenes.size(), 2u);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "boxes/scenes/box_00001.glb"));
  const Outcome info = run("info boxes --deep --json i.json");
  EXPECT_EQ(info.code, 0) << info.error;
  EXPECT_THAT(info.output, HasSubstr("scenes: 2"));
  EXPECT_EQ(nlohmann::json::parse(read_file(folder_ / "i.json"))["kind"], "dataset");
}

TEST_F(Command, PrintConfigShowsOverridesAndWritesNothing) {
  const Outcome outcome =
      run("generate --config tiny.yaml --print-config --scenes 3 --seed 9 --set rays=77");
  EXPECT_EQ(outcome.code, 0) << outcome.error;
  const DatagenConfig config = read_datagen_config(Config::parse(outcome.output, "printed"));
  EXPECT_EQ(config.scenes, 3);
  EXPECT_EQ(config.seed, 9u);
  EXPECT_EQ(config.bake.rays, 77);
}

TEST_F(Command, GenerateNamesBadConfigsAndPlaces) {
  expect_failure(1, "none.yaml", run("generate --config none.yaml --out x"));
  write_file(folder_ / "key.yaml", "parent: tiny.yaml\nscene_pionts: 4\n");
  expect_failure(1, "scene_points", run("generate --config key.yaml --out x"));
  write_file(folder_ / "type.yaml", "parent: tiny.yaml\nrays: lots\n");
  expect_failure(1, "rays", run("generate --config type.yaml --out x"));
  write_file(folder_ / "range.yaml", "parent: tiny.yaml\nrays: 0\n");
  expect_failure(1, "range.yaml: rays", run("generate --config range.yaml --out x"));
  for (const char* shard : {"3/3", "3/2", "0/0", "-1/2", "1", "x", "1/", "/2", "1/2/3", "1/2 "})
    expect_failure(1, concat("--shard: expected I/N with 0 <= I < N, got \"", shard, "\""),
                   run(concat("generate --config tiny.yaml --out x --shard '", shard, "'")));
  expect_failure(1, "none/config.yaml", run("generate --out none --resume"));
  expect_failure(1, "none", run("generate --out none --merge"));
  expect_failure(1, "--out is missing", run("generate --config tiny.yaml"));
  expect_failure(1, "box.glb/x", run("generate --config tiny.yaml --out box.glb/x"));
  expect_failure(1, "/proc/none", run("generate --config tiny.yaml --out /proc/none"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "x"));
}

TEST_F(Command, BakeWritesASampleAndNamesBadInput) {
  const std::string small =
      " --scene-points 32 --queries 16 --rays 8 --views 1 --view-width 8 --view-height 8"
      " --view-rays 8 --quiet ";
  EXPECT_EQ(run("bake box.glb --out box.safetensors" + small).code, 0);
  EXPECT_EQ(data::read_scene_sample(folder_ / "box.safetensors").query_points(), 16);
  EXPECT_THAT(run("info box.safetensors").output, HasSubstr("query_points: 16"));
  EXPECT_THAT(run("info box.glb").output, HasSubstr("triangles: 12"));
  EXPECT_THAT(run("bake box.glb --validate-only").output, HasSubstr("valid scene, 12 triangles"));

  expect_failure(1, "none.glb", run("bake none.glb --out a.safetensors" + small));
  const std::string bytes = read_file(folder_ / "box.glb");
  write_file(folder_ / "cut.glb", bytes.substr(0, bytes.size() / 2));
  expect_failure(1, "cut.glb", run("bake cut.glb --out a.safetensors" + small));
  expect_failure(1, "cut.glb", run("bake cut.glb --validate-only --quiet"));
  expect_failure(1, "rays", run("bake box.glb --out a.safetensors --rays 0 --quiet"));
  expect_failure(1, "--out is missing", run("bake box.glb --quiet"));
  expect_failure(1, "tiny.yaml/a.safetensors",
                 run("bake box.glb --out tiny.yaml/a.safetensors" + small));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "a.safetensors"));
}

TEST_F(Command, BakeStoresIncidentRadianceAndInfoShowsIt) {
  const std::string bake =
      "bake box.glb --out b.safetensors --scene-points 16 --queries 8 --rays 8 --views 0 ";
  ASSERT_EQ(run(bake + "--incident-points 2 --incident-bins 4 --incident-samples 8 --quiet").code,
            0);
  ASSERT_EQ(run("info b.safetensors --json info.json").code, 0);
  const auto incident = nlohmann::json::parse(read_file(folder_ / "info.json"))["incident"];
  EXPECT_EQ(incident["points"], 2);
  EXPECT_EQ(incident["bins"], 4);
  EXPECT_EQ(incident["samples"], 8);
  EXPECT_GT(incident["bytes"], 2 * 2 * 16 * 3 * 2);
  expect_failure(1, "incident.bins", run(bake + "--incident-points 2 --incident-bins 5"));
}

TEST_F(Command, BakesTheViewsOfTheCamerasThatAreNamed) {
  scene::Scene scene = furnace(2, 0.5f);
  const Vec3 middle = scene.bounds().center();
  for (const char* name : {"left", "right"}) {
    const float side = name[0] == 'l' ? -0.4f : 0.4f;
    scene.cameras.push_back({name, middle, middle + Vec3{side, 0, 0.1f}, {0, 1, 0}, 60});
  }
  scene::write_glb(folder_ / "two.glb", scene);
  const auto bake = [&](const std::string& flags) {
    const std::string small =
        " --scene-points 64 --queries 16 --rays 2 --view-width 8 --view-height 6 --view-rays 2";
    const Outcome done = run("bake two.glb --quiet --out v.safetensors" + small + flags);
    EXPECT_EQ(done.code, 0) << done.error;
    return data::read_scene_sample(folder_ / "v.safetensors").views;
  };
  const auto all = bake(" --camera all");
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(bake(" --camera all --views 1").size(), 1u);
  const auto right = bake(" --camera right"), second = bake(" --camera 1");
  ASSERT_EQ(right.size(), 1u);
  EXPECT_EQ(right[0].position, second[0].position);
  EXPECT_TRUE(right[0].position == all[0].position || right[0].position == all[1].position);
  // What info prints is a camera file.
  ASSERT_EQ(run("info two.glb --json info.json").code, 0);
  EXPECT_EQ(bake(" --camera info.json")[0].position, all[0].position);
  const auto info = nlohmann::json::parse(read_file(folder_ / "info.json"));
  write_file(folder_ / "entry.json", info["camera_list"][1].dump());
  EXPECT_EQ(bake(" --camera entry.json")[0].position, right[0].position);
  expect_failure(1, "\"left\"", run("bake two.glb --out a.safetensors --camera lef"));
}

TEST_F(Command, InfoSaysWhichUnitARoomMustBeIn) {
  scene::Scene scene = furnace(2, 0.5f);
  scene::write_glb(folder_ / "m.glb", scene);
  for (scene::Instance& instance : scene.instances)
    for (auto& row : instance.to_world.m)
      for (float& value : row) value *= 250;
  scene::write_glb(folder_ / "cm.glb", scene);
  EXPECT_THAT(run("info m.glb").output, Not(HasSubstr("likely_unit")));
  EXPECT_THAT(run("info cm.glb").output, HasSubstr("likely_unit: centimetres"));
}

TEST_F(Command, ReadsObjAndCountsItsFaults) {
  write_file(folder_ / "two.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 2 3 1\nf 1 2 2\n");
  EXPECT_THAT(run("info two.obj").output,
              AllOf(HasSubstr("triangles: 3\n"), HasSubstr("unit: \"metre, assumed"),
                    HasSubstr("  duplicate_triangles: 1\n"), HasSubstr("degenerate_triangles: 1")));
  for (const char* command : {"bake", "probe", "info"}) {
    EXPECT_THAT(run(concat(command, " two.obj --validate-only")).output, HasSubstr("valid scene"));
    write_file(folder_ / "bad.obj", "v 0 0 0\nf 1 2 3\n");
    expect_failure(1, "bad.obj: line 2", run(concat(command, " bad.obj --validate-only --quiet")));
  }
}

TEST_F(Command, FullDiskIsAnErrorAndLeavesNothing) {
  // ulimit counts blocks of 1024 bytes; with the signal ignored, write fails as it does on a full
  // disk.
  const Outcome outcome =
      run("bake box.glb --out a.safetensors --scene-points 4096 --queries 64 --rays 8 --views 0 "
          "--quiet",
          "trap '' XFSZ && ulimit -f 16 && ");
  expect_failure(1, "a.safetensors", outcome);
  for (const auto& entry : std::filesystem::directory_iterator(folder_))
    EXPECT_THAT(entry.path().filename().string(), Not(HasSubstr("safetensors")));
}

TEST_F(Command, ProbeWritesColumnsAndNamesBadInput) {
  write_file(folder_ / "points.csv", "px,py,pz,nx,ny,nz\n0.5,0,0.5,0,1,0\n0.2,1,0.5,0,-1,0\n");
  const Outcome outcome = run("probe box.glb --points points.csv --out out.csv --rays 64 --quiet");
  EXPECT_EQ(outcome.code, 0) << outcome.error;
  const std::string text = read_file(folder_ / "out.csv");
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 3);
  EXPECT_EQ(
      run("probe box.glb --points points.csv --out again.csv --rays 64 --quiet --threads 1").code,
      0);
  EXPECT_EQ(read_file(folder_ / "again.csv"), text);
  EXPECT_THAT(
      run("probe box.glb --points points.csv --out c.csv --target-error 1e-5 --rays 64").error,
      HasSubstr("2 of 2 points are above --target-error"));

  write_file(folder_ / "bad.csv", "px,py,pz,nx,ny,nz\n0.5,0,0.5,0,up,0\n");
  expect_failure(1, "bad.csv: line 2, column ny",
                 run("probe box.glb --points bad.csv --out b.csv --quiet"));
  expect_failure(1, "none.csv", run("probe box.glb --points none.csv --out b.csv --quiet"));
  expect_failure(1, "none.glb", run("probe none.glb --points points.csv --out b.csv --quiet"));
  expect_failure(1, "--points is missing", run("probe box.glb --out b.csv --quiet"));
  expect_failure(1, "tiny.yaml/b.csv",
                 run("probe box.glb --points points.csv --out tiny.yaml/b.csv --quiet"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "b.csv"));
}

/// The irradiance outside the closed box: pi times the radiance of the sky.
TEST_F(Command, EnvironmentsLightAnyScene) {
  write_file(folder_ / "points.csv", "px,py,pz,nx,ny,nz\n0.5,1,0.5,0,1,0\n");
  const std::string probe = "probe box.glb --points points.csv --out out.csv --rays 16384 --quiet ";
  EXPECT_EQ(run(probe + "--environment 1,2,3").code, 0);
  // The lamp inside gets a share of the light samples: that is the noise.
  std::array<double, 3> total{};
  const std::string csv = read_file(folder_ / "out.csv");
  const char* row = csv.c_str() + csv.find('\n') + 1;
  ASSERT_EQ(
      std::sscanf(row, "%*f,%*f,%*f,%*f,%*f,%*f,%lf,%lf,%lf", &total[0], &total[1], &total[2]), 3);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(total[c] / (c + 1), std::numbers::pi, 0.03);
  EXPECT_THAT(run("info box.glb --environment 1,2,3").output,
              HasSubstr("name: environment, kind: environment"));
  const Outcome bake =
      run("bake box.glb --out sky.safetensors --scene-points 100 --queries 20 --rays 8 --views 0 "
          "--environment 1,1,1 --quiet");
  EXPECT_EQ(bake.code, 0) << bake.error;
  const data::SceneSample sample = data::read_scene_sample(folder_ / "sky.safetensors");
  EXPECT_EQ(sample.scene_points(), 100);
  EXPECT_EQ(sample.light_groups, 2);
  EXPECT_EQ(std::count(sample.scene_light.begin(), sample.scene_light.end(), 1), 5);

  expect_failure(1, "environment 1,2", run(probe + "--environment 1,2"));
  expect_failure(1, "sky.exr", run(probe + "--environment sky.exr"));
  expect_failure(1, "--environment-turn needs", run(probe + "--environment-turn 3"));
  expect_failure(1, "baked already", run("info sky.safetensors --environment 1,1,1"));
}

TEST_F(Command, InfoNamesBadInput) {
  expect_failure(1, "none", run("info none"));
  expect_failure(1, "dataset.json", run("info ."));
  write_file(folder_ / "cut.safetensors", "12345678{");
  expect_failure(1, "cut.safetensors", run("info cut.safetensors"));
  expect_failure(1, "tiny.yaml", run("info tiny.yaml"));
}

TEST_F(Command, ConcurrentShardsGiveTheWholeDataset) {
  ASSERT_EQ(run("generate --config tiny.yaml --out whole --quiet").code, 0);
  const std::string tool = concat(
      "'", LTE_BINARY_DIR, "/bin/lte_datagen' generate --config tiny.yaml --out shards --quiet");
  const std::string both =
      concat("cd '", folder_.string(), "' && { ", tool, " --shard 0/2 & A=$!; ", tool,
             " --shard 1/2 & B=$!; wait $A && wait $B; }");
  ASSERT_EQ(std::system(both.c_str()), 0);
  EXPECT_EQ(files("shards"), files("whole"));
}

TEST_F(Command, ResumeAndMergeNeedNoConfig) {
  ASSERT_EQ(run("generate --config tiny.yaml --out whole --quiet").code, 0);
  ASSERT_EQ(run("generate --config tiny.yaml --out part --shard 0/2 --quiet").code, 0);
  expect_failure(1, "unfinished", run("info part"));
  EXPECT_THAT(run("info part").error, AllOf(HasSubstr("--resume"), HasSubstr("--merge")));
  const Outcome merged = run("generate --out part --merge");
  EXPECT_EQ(merged.code, 0);
  EXPECT_THAT(merged.error, HasSubstr("2 of 5 scenes are missing"));
  EXPECT_THAT(run("info part").output, HasSubstr("planned: 5"));
  ASSERT_EQ(run("generate --out part --resume --json r.json").code, 0);
  const auto result = nlohmann::json::parse(read_file(folder_ / "r.json"));
  EXPECT_EQ(result["kept"], 3);
  EXPECT_EQ(result["baked"], 2);
  EXPECT_EQ(files("part"), files("whole"));
}

TEST_F(Command, AFailedSceneIsCountedAndTheExitCodeSaysSo) {
  ASSERT_EQ(run("generate --config tiny.yaml --out whole --quiet").code, 0);
  ASSERT_EQ(run("generate --config tiny.yaml --out a --shard 0/2 --quiet").code, 0);
  // A directory in place of its file: the scene cannot be written.
  std::filesystem::create_directory(folder_ / "a/scenes/box_00001.safetensors");
  const Outcome outcome = run("generate --config tiny.yaml --out a --resume --json r.json");
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.error, AllOf(HasSubstr("1 scenes failed"), HasSubstr("box_00001: ")));
  const auto result = nlohmann::json::parse(read_file(folder_ / "r.json"));
  EXPECT_EQ(result["failed"], 1);
  EXPECT_EQ(result["baked"], 1);
  EXPECT_EQ(result["listed"], 4);
  EXPECT_THAT(run("generate --config tiny.yaml --out a --resume --strict").error,
              HasSubstr("--strict"));
  std::filesystem::remove(folder_ / "a/scenes/box_00001.safetensors");
  EXPECT_EQ(run("generate --config tiny.yaml --out a --resume").code, 0);
  EXPECT_EQ(files("a"), files("whole"));
}

TEST_F(Command, AKillLosesTheSceneInWorkAtMost) {
  const std::string arguments =
      "generate --config tiny.yaml --quiet --scenes 6 --set rays=1500 --out ";
  ASSERT_EQ(run(arguments + "whole").code, 0);
  for (const char* signal : {"TERM", "KILL"}) {
    const std::string out = concat("killed_", signal);
    // Waits for the first finished scene, kills, and reports what is left of the process.
    const std::string line =
        concat("cd '", folder_.string(), "' && { '", LTE_BINARY_DIR, "/bin/lte_datagen' ",
               arguments, out, " 2> said.txt & P=$!; while [ ! -e ", out,
               "/scenes/box_00000.safetensors ] && kill -0 $P 2>/dev/null; do "
               "sleep 0.01; done; kill -",
               signal, " $P; wait $P; true; }");
    write_file(folder_ / "kill.sh", line);
    ASSERT_EQ(
        std::system(concat("bash '", (folder_ / "kill.sh").string(), "' 2> /dev/null").c_str()), 0);
    if (signal == std::string("TERM")) {
      EXPECT_EQ(read_file(folder_ / "said.txt"),
                "killed_TERM: stopped; the finished scenes stay, go on with --resume\n");
    }
    const auto whole = files("whole");
    for (const auto& [name, bytes] : files(out)) {
      if (name == "dataset.json" || !whole.count(name)) continue;
      EXPECT_EQ(bytes, whole.at(name)) << name << " after " << signal;
    }
    EXPECT_EQ(run(arguments + out + " --resume").code, 0);
    EXPECT_EQ(files(out), whole) << "after " << signal;  // no temporary is left either
  }
}

TEST_F(Command, ScenesReadNothingOutsideTheirFolderUnlessAllowed) {
  std::filesystem::create_directory(folder_ / "inner");
  write_file(folder_ / "part.pbrt", "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0]\n");
  write_file(folder_ / "inner" / "s.pbrt", "WorldBegin\nInclude \"../part.pbrt\"\n");
  for (const char* command : {"info", "bake --validate-only", "probe --validate-only"}) {
    const Outcome refused = run(concat(command, " inner/s.pbrt"));
    expect_failure(1, "inner/s.pbrt:2: \"../part.pbrt\" lies outside", refused);
    EXPECT_THAT(refused.error, HasSubstr("(--allow-outside)"));
    EXPECT_EQ(run(concat(command, " inner/s.pbrt --allow-outside")).code, 0) << command;
  }
  const std::string rooms =
      concat("generate --config ", LTE_SOURCE_DIR, "/configs/data/demo.yaml --out rooms ");
  expect_failure(1, "--allow-outside goes with generator: files", run(rooms + "--allow-outside"));
  expect_failure(1, "--limits goes with generator: files", run(rooms + "--limits pictures=2GB"));
}

TEST_F(Command, LimitsOfScenesAreFlags) {
  const Outcome refused = run("info box.glb --limits triangles=1");
  expect_failure(1, "more than 1 triangles", refused);
  EXPECT_THAT(refused.error, HasSubstr("(--limits triangles="));
  EXPECT_EQ(run("info box.glb --limits triangles=1k,pictures=2GB").code, 0);
  expect_failure(2, "did you mean triangles?", run("info box.glb --limits triangels=1k"));
}

}  // namespace
}  // namespace lte::datagen::test
