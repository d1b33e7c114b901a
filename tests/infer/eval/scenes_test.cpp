// lte_eval scenes as its users run it: a folder with a lit scene, a dark one and a broken one.
#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "lte/base/file.h"
#include "lte/image/exr.h"
#include "lte/scene/find_scenes.h"
#include "tests/infer/tools_fixture.h"

namespace lte::infer {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class Scenes : public Tools {
 protected:
  void SetUp() override {
    fs::remove_all(at("set"));
    fs::create_directories(at("set/inner"));
    fs::copy(at("room.glb"), at("set/room.glb"));
    fs::copy(at("dark.glb"), at("set/inner/dark.glb"));
    write_file(at("set/broken.gltf"), "{");
  }
  void TearDown() override {
    for (const char* name : {"set", "report", "kept", "empty"}) fs::remove_all(at(name));
  }
  static Outcome scenes(const std::string& rest) {
    return run_tool("lte_eval", "scenes " + rest + " --quiet --size 32x24 --checkpoint " +
                                    at("tiny.safetensors"));
  }
  static nlohmann::json json(const std::string& name) {
    return nlohmann::json::parse(read_file(at(name)));
  }
  static nlohmann::json scene_of(const nlohmann::json& run, const std::string& name) {
    for (const nlohmann::json& scene : run.at("scenes")) {
      if (scene.at("name") == name) return scene;
    }
    ADD_FAILURE() << "no scene " << name;
    return {};
  }
  /// The only file of a folder with this extension.
  static fs::path only(const std::string& folder, const std::string& extension) {
    std::vector<fs::path> found;
    for (const fs::directory_entry& entry : fs::directory_iterator(at(folder))) {
      if (entry.path().extension() == extension) found.push_back(entry.path());
    }
    EXPECT_EQ(found.size(), 1u);
    return found.at(0);
  }
  static void write_camera(const Vec3& origin, const Vec3& target) {
    const nlohmann::json camera{{"origin", {origin.x, origin.y, origin.z}},
                                {"target", {target.x, target.y, target.z}},
                                {"vfov", 60}};
    write_file(at("set/room.camera.json"), camera.dump());
  }
};

TEST_F(Scenes, OfEveryKindInOneRun) {
  const std::string all = at("set") +
                          " --methods network,decoded,gather,paths-8,paths-8-denoised,gather-draft "
                          "--reference-spp 64 --report " +
                          at("report");
  const Outcome done = scenes(all + " --json " + at("a.json"));
  ASSERT_EQ(done.code, 0) << done.text;
  EXPECT_THAT(done.text, AllOf(HasSubstr("(1) network tiny"), HasSubstr("(5) paths-8-denoised"),
                               HasSubstr("1 of 1"), HasSubstr("broken.gltf: not measured: "),
                               HasSubstr("2 scenes measured, 1 refused or dark")));
  const nlohmann::json run = json("a.json");
  EXPECT_EQ(run.at("reference_spp"), 64);
  ASSERT_EQ(run.at("methods").size(), 6u);
  EXPECT_EQ(run["methods"][0].at("name"), "network tiny");
  EXPECT_EQ(run["methods"][1].at("checkpoint"), at("tiny.safetensors"));

  EXPECT_THAT(scene_of(run, "broken.gltf").at("error").get<std::string>(),
              HasSubstr("broken.gltf"));
  const nlohmann::json dark = scene_of(run, "inner/dark.glb");
  EXPECT_TRUE(dark.at("error").is_null());
  EXPECT_THAT(dark.at("notes").dump(), HasSubstr("without light; added an environment"));
  EXPECT_THAT(dark.at("methods").at("network tiny").at("not_measured").get<std::string>(),
              HasSubstr("trained without"));

  const nlohmann::json room = scene_of(run, "room.glb");
  EXPECT_EQ(room.at("camera_from"), "scene");
  EXPECT_EQ(room.at("camera").at("name"), "inside");
  const nlohmann::json& methods = room.at("methods");
  for (const char* light : {"irradiance", "whole"}) {
    SCOPED_TRACE(light);
    EXPECT_NEAR(methods["gather"][light]["mean_ratio"].get<double>(), 1, 0.08);
    EXPECT_NEAR(methods["paths-8"][light]["mean_ratio"].get<double>(), 1, 0.08);
    // Paths are stratified: their variance falls faster than 1/n.
    EXPECT_GT(methods["paths-8"][light]["worth"].get<double>(), 3);
    EXPECT_LT(methods["paths-8"][light]["worth"].get<double>(), 16);
    EXPECT_GT(methods["paths-8-denoised"][light]["worth"].get<double>(),
              methods["paths-8"][light]["worth"].get<double>());
  }
  EXPECT_LT(methods["gather-draft"]["irradiance"]["worth"],
            methods["gather"]["irradiance"]["worth"]);
  EXPECT_FALSE(methods["decoded tiny"].at("right")) << "its weights are random";
  EXPECT_GT(methods["network tiny"].at("seconds"), 0);
  EXPECT_LT(methods["gather"]["whole"].at("flip"), methods["paths-8"]["whole"].at("flip"));

  const std::string page = read_file(at("report/report.html"));
  size_t pictures = 0;
  for (size_t p = page.find("data:image/png"); p != std::string::npos;
       p = page.find("data:image/png", p + 1))
    ++pictures;
  size_t measured = 0;  // with the reference of each scene
  for (const nlohmann::json& scene : run.at("scenes")) {
    for (const nlohmann::json& method : scene.at("methods"))
      measured += method.contains("not_measured") ? 0 : 1;
    measured += scene.at("error").is_null() ? 1 : 0;
  }
  EXPECT_EQ(pictures, measured);
  EXPECT_GE(pictures, 6u + 4u);
  EXPECT_THAT(page, AllOf(HasSubstr("broken.gltf"), Not(HasSubstr("src=\"http"))));

  // Started again, nothing is computed anew, not even seconds.
  const Outcome again = scenes(all + " --resume --json " + at("b.json"));
  ASSERT_EQ(again.code, 0) << again.text;
  EXPECT_EQ(read_file(at("b.json")), read_file(at("a.json")));
  EXPECT_EQ(again.text, done.text);
  EXPECT_EQ(read_file(at("report/report.html")), page);
  // What is missing is measured, by the references that are kept.
  for (const fs::directory_entry& entry : fs::directory_iterator(at("report/results"))) {
    if (entry.path().filename().string().find("gather") != std::string::npos)
      fs::remove(entry.path());
  }
  ASSERT_EQ(scenes(all + " --resume --json " + at("c.json")).code, 0);
  nlohmann::json first = scene_of(run, "room.glb"), third = scene_of(json("c.json"), "room.glb");
  EXPECT_EQ(third["methods"]["paths-8"], first["methods"]["paths-8"]);
  for (const char* time : {"seconds", "processor_seconds"}) {
    first["methods"]["gather"].erase(time);
    third["methods"]["gather"].erase(time);
  }
  EXPECT_EQ(third["methods"]["gather"], first["methods"]["gather"]);
}

TEST_F(Scenes, ResultsOfOtherSettingsAreNotTaken) {
  const std::string base =
      at("set/room.glb") + " --methods paths-2 --report " + at("report") + " --json ";
  ASSERT_EQ(scenes(base + at("a.json") + " --reference-spp 4").code, 0);
  ASSERT_EQ(scenes(base + at("b.json") + " --reference-spp 4 --seed 1 --resume").code, 0);
  ASSERT_EQ(scenes(base + at("c.json") + " --reference-spp 4 --seed 1 --resume").code, 0);
  EXPECT_NE(json("a.json").at("scenes"), json("b.json").at("scenes"));
  EXPECT_EQ(json("b.json"), json("c.json"));
}

TEST_F(Scenes, ReferencesAreKeptByScene) {
  const std::string base = " --methods paths-2 --reference-spp 4 --references " + at("kept");
  ASSERT_EQ(scenes(at("set/room.glb") + base).code, 0);
  const fs::path first = only("kept", ".exr");
  ASSERT_EQ(scenes(at("set/room.glb") + base).code, 0);
  EXPECT_EQ(only("kept", ".exr"), first);
  // The same name, and half of the light.
  scene::Scene room = test::furnished_room();
  room.cameras.push_back({"inside", {2, 1.6F, 2.8F}, {2, 1, 0}, {0, 1, 0}, 70});
  for (scene::Material& material : room.materials) material.emission *= 0.5F;
  scene::write_glb(at("set/room.glb"), room);
  ASSERT_EQ(scenes(at("set/room.glb") + base).code, 0);
  EXPECT_EQ(std::distance(fs::directory_iterator(at("kept")), {}), 2);
}

TEST_F(Scenes, WithoutAFolderNothingIsWritten) {
  const std::vector<std::string> before = folder_->names();
  const Outcome done = scenes(at("set/room.glb") + " --methods paths-2 --reference-spp 4");
  EXPECT_EQ(done.code, 0) << done.text;
  EXPECT_EQ(folder_->names(), before);
}

TEST_F(Scenes, DamagedAndForeignReferencesAreNamed) {
  const std::string run =
      at("set/room.glb") + " --methods paths-2 --reference-spp 4 --references " + at("kept");
  ASSERT_EQ(scenes(run).code, 0);
  const fs::path file = only("kept", ".exr");
  const std::string bytes = read_file(file);
  const std::string header = *image::read_exr_text(file, "lteReferencePair");

  std::string cut = bytes.substr(0, bytes.size() / 2);
  write_file(file, cut);
  expect_failure(scenes(run), 1, AllOf(HasSubstr(file.string()), HasSubstr("damaged")));
  write_file(file, "no picture");
  expect_failure(scenes(run), 1, AllOf(HasSubstr(file.string()), HasSubstr("no reference")));

  write_file(file, bytes);
  const auto rewrite = [&](const std::string& text, float factor) {
    std::vector<image::Image> pictures;
    std::vector<image::Layer> layers;
    const std::vector<std::string> names = {"",     "indirect",      "irradiance",
                                            "half", "indirect_half", "irradiance_half"};
    pictures.reserve(names.size());
    write_file(file, bytes);
    for (const std::string& name : names) {
      pictures.push_back(image::read_exr(file, name));
      for (float& value : pictures.back().pixels) value *= factor;
      layers.push_back({name, &pictures.back()});
    }
    image::write_exr(file, layers, {{"lteReferencePair", text}});
  };
  rewrite(header, 1);
  EXPECT_EQ(scenes(run).code, 0) << "or the next two say nothing";
  rewrite(header, 2);
  expect_failure(scenes(run), 1, HasSubstr("damaged reference"));
  nlohmann::json other = nlohmann::json::parse(header);
  other["version"] = "0.0.1";
  rewrite(other.dump(), 1);
  expect_failure(scenes(run), 1,
                 AllOf(HasSubstr(file.string()), HasSubstr("another version, lte 0.0.1")));
  other = nlohmann::json::parse(header);
  other["traced"] = "0";
  rewrite(other.dump(), 1);
  expect_failure(scenes(run), 1, HasSubstr("another path tracer"));
}

TEST_F(Scenes, TheCameraBesideASceneIsTaken) {
  write_camera({1, 1.2F, 2.5F}, {3, 0.8F, 0});
  const std::string run = at("set/room.glb") + " --methods paths-2 --reference-spp 4";
  const Outcome done = scenes(run + " --json " + at("a.json"));
  ASSERT_EQ(done.code, 0) << done.text;
  const nlohmann::json room = scene_of(json("a.json"), "room.glb");
  EXPECT_EQ(room.at("camera_from"), "camera file");
  EXPECT_EQ(room.at("camera").at("origin")[0], 1);
  const auto words = [&](const char* what) {
    return AllOf(HasSubstr("room.camera.json"), HasSubstr(what), HasSubstr("another scene"));
  };
  write_camera({100, 1, 1}, {0, 1, 1});
  expect_failure(scenes(run), 1, words("stands far outside of room.glb"));
  write_camera({9, 2, 2.8F}, {20, 2, 2.8F});
  expect_failure(scenes(run), 1, words("sees nothing of room.glb"));
  write_camera({9, 2, 2.8F}, {2, 1, 0});  // the room's walls from outside, where no light is
  expect_failure(scenes(run), 1, words("sees no light in room.glb"));
  write_file(at("set/room.camera.json"), "{}");
  expect_failure(scenes(run), 1, HasSubstr("room.camera.json"));
}

TEST_F(Scenes, BadInputIsOneLine) {
  fs::create_directory(at("empty"));
  expect_failure(scenes(at("empty")), 1, AllOf(HasSubstr("empty: no scene"), HasSubstr(".glb")));
  expect_failure(scenes(at("none.glb")), 1, HasSubstr("none.glb: no such file"));
  expect_failure(scenes(at("tiny.safetensors")), 1, HasSubstr("tiny.safetensors: is no scene"));
  expect_failure(scenes(at("set/broken.gltf") + " --methods paths-2"), 1, HasSubstr("broken.gltf"));
  expect_failure(scenes(at("set/room.glb") + " --methods guess"), 1,
                 AllOf(HasSubstr("--methods: \"guess\""), HasSubstr("paths-N")));
  expect_failure(scenes(at("set/room.glb") + " --methods paths-0"), 1, HasSubstr("paths-0"));
  expect_failure(scenes(at("set/room.glb") + " " + at("set/room.glb")), 1, HasSubstr("twice"));
  expect_failure(run_tool("lte_eval", "scenes " + at("set/room.glb") + " --size 8x8"), 1,
                 HasSubstr("--size 8x8"));
  EXPECT_EQ(scenes(at("set/room.glb") + " --resume").code, 2);
  EXPECT_EQ(run_tool("lte_eval", "--split test scenes " + at("set/room.glb")).code, 2);
  EXPECT_EQ(scenes(at("set/room.glb") + " --split test").code, 2);
}

TEST_F(Scenes, PartsOfOtherScenesAreLeftOut) {
  fs::create_directories(at("set/mesh"));
  write_file(at("set/scene.pbrt"),
             "WorldBegin\nShape \"plymesh\" \"string filename\" \"mesh/a.ply\"");
  write_file(at("set/materials.pbrt"), "Material \"diffuse\"");
  for (const char* name : {"mesh/a.ply", "mesh/b.PLY", "c.txt"})
    write_file(at(std::string("set/") + name), "");
  const scene::FoundScenes found = scene::find_scenes({at("set")});
  std::vector<std::string> names;
  for (const scene::FoundScene& scene : found.scenes) names.push_back(scene.name);
  EXPECT_THAT(names, testing::UnorderedElementsAre("broken.gltf", "inner/dark.glb", "mesh/b.PLY",
                                                   "room.glb", "scene.pbrt"));
  EXPECT_EQ(found.parts, 2);
}

}  // namespace
}  // namespace lte::infer
