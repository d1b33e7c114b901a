#include "datagen/commands/info.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "datagen/dataset/generate.h"
#include "lte/base/log.h"
#include "lte/data/dataset.h"
#include "lte/scene/load_camera.h"
#include "tests/data/sample_fixture.h"
#include "tests/datagen/scenes.h"

namespace lte::datagen::test {
namespace {

using data::test::error_of;
using ::testing::HasSubstr;

TEST(GroupPowers, AreaLightsHavePiTimesRadianceTimesArea) {
  scene::Scene scene = furnace(2, 0.5f);  // 6 m²
  EXPECT_NEAR(group_powers(scene).at(0).x, 6 * kPi * 2, 1e-3);
  scene.materials[0].double_sided = true;
  EXPECT_NEAR(group_powers(scene).at(0).y, 12 * kPi * 2, 1e-3);
  scene.instances[0].to_world.m[0][0] = 2;  // four faces double: 10 m²
  EXPECT_NEAR(group_powers(scene).at(0).z, 20 * kPi * 2, 1e-3);
}

TEST(GroupPowers, PunctualLightsIntegrateTheirIntensity) {
  scene::Scene scene = furnace(0, 0.5f);
  scene.instances[0].light_group = scene::kNone;
  scene.light_groups = {"point", "spot", "sun"};
  scene::PunctualLight light;
  light.intensity = {1, 2, 3};
  light.light_group = 0;
  scene.lights = {light, light, light};
  scene.lights[1].kind = scene::LightKind::Spot;
  scene.lights[1].light_group = 1;
  scene.lights[1].inner_cone = 0.4f;
  scene.lights[1].outer_cone = 0.9f;
  scene.lights[2].kind = scene::LightKind::Directional;
  scene.lights[2].light_group = 2;
  const std::vector<Rgb> powers = group_powers(scene);
  EXPECT_NEAR(powers[0].y, 8 * kPi, 1e-4);
  EXPECT_EQ(powers[2], Rgb{});
  double spot = 0;  // the same by midpoint rule over the polar angle
  constexpr int kSteps = 20000;
  for (int i = 0; i < kSteps; ++i) {
    const double theta = (i + 0.5) * 0.9 / kSteps;
    const double fall =
        std::clamp((std::cos(theta) - std::cos(0.9)) / (std::cos(0.4) - std::cos(0.9)), 0.0, 1.0);
    spot += 2 * M_PI * std::sin(theta) * fall * fall * 0.9 / kSteps;
  }
  EXPECT_NEAR(powers[1].x, spot, 1e-4);
}

TEST(Info, SceneSaysWhatItHolds) {
  scene::Scene scene = furnace(2, 0.5f);
  scene.ignored = {"extension KHR_materials_sheen (3 materials)"};
  const Json info = scene_info(scene);
  EXPECT_EQ(info["kind"], "scene");
  EXPECT_EQ(info["triangles"], 12);
  EXPECT_EQ(info["instances"], 1);
  EXPECT_NEAR(info["area_m2"].get<double>(), 6, 1e-5);
  EXPECT_EQ(info["bounds"]["high"], Json::array({1.0, 1.0, 1.0}));
  EXPECT_EQ(info["light_groups"][0]["name"], "cube");
  EXPECT_THAT(to_yaml(info), HasSubstr("KHR_materials_sheen"));
  EXPECT_THAT(to_yaml(info), HasSubstr("triangles: 12\n"));
}

TEST(Info, ListsTexturesCamerasUnitAndFaults) {
  scene::Scene scene = furnace(2, 0.5f);
  scene.unit = "metre, assumed";
  scene.textures = {
      std::make_shared<scene::Texture>(4, 2, std::vector<uint8_t>(24), /*srgb=*/true)};
  scene.materials[0].base_color_texture.texture = 0;
  scene.cameras.resize(1);
  scene.cameras[0].name = "door";
  scene::Instance twin = scene.instances[0];
  scene.instances.push_back(twin);
  const Json info = scene_info(scene);
  EXPECT_EQ(info["triangles"], 24);
  EXPECT_EQ(info["stored_triangles"], 12);
  EXPECT_EQ(info["unit"], "metre, assumed");
  EXPECT_EQ(info["texture_list"][0]["width"], 4);
  EXPECT_EQ(info["texture_list"][0]["height"], 2);
  EXPECT_EQ(info["texture_list"][0]["bytes"], scene.textures[0]->size_bytes());
  EXPECT_EQ(info["texture_list"][0]["uses"], 1);
  EXPECT_EQ(info["texture_list"][0]["name"], "base color of " + scene.materials[0].name);
  EXPECT_EQ(info["camera_list"][0]["name"], "door");
  EXPECT_EQ(info["camera_list"][0], Json::parse(scene::camera_json(scene.cameras[0])));
  EXPECT_EQ(info["light_groups"][0]["kind"], "surface");
  EXPECT_EQ(info["geometry"]["duplicate_triangles"], 12);
  EXPECT_EQ(info["geometry"]["inward_shells"], 1);
  EXPECT_THAT(to_yaml(info), HasSubstr("  duplicate_triangles: 12\n"));
}

TEST(Info, TextIsYaml) {
  const Json info = {{"name", "a room, large"},
                     {"unit", "metre"},
                     {"hash", "12e4"},
                     {"word", "no"},
                     {"missing", "~"},
                     {"empty", ""},
                     {"list", {{{"name", "lamp: 3"}, {"size", {1, 2}}}, {{"name", "lamp.4"}}}},
                     {"none", Json::array()},
                     {"map", {{"note", "it's #1"}}}};
  EXPECT_EQ(to_yaml(info),
            "name: a room, large\n"
            "unit: metre\n"
            "hash: \"12e4\"\n"
            "word: \"no\"\n"
            "missing: \"~\"\n"
            "empty: \"\"\n"
            "list:\n"
            "  - {name: \"lamp: 3\", size: [1, 2]}\n"
            "  - {name: lamp.4}\n"
            "none: []\n"
            "map:\n"
            "  note: \"it's #1\"\n");
}

TEST(Info, SunsHaveIrradiance) {
  scene::Scene scene = furnace(2, 0.5f);
  scene::PunctualLight sun;
  sun.kind = scene::LightKind::Directional;
  sun.intensity = {1, 2, 3};
  sun.light_group = 1;
  scene.lights = {sun};
  scene.light_groups.push_back("sun");
  const Json info = scene_info(scene);
  EXPECT_FALSE(info["light_groups"][1].contains("power_w"));
  EXPECT_EQ(info["light_groups"][1]["irradiance_w_m2"], Json::array({1.0, 2.0, 3.0}));
  EXPECT_TRUE(info["light_groups"][0].contains("power_w"));
  EXPECT_THAT(to_yaml(info),
              HasSubstr("  - {name: sun, kind: directional, irradiance_w_m2: [1.0, 2.0, 3.0]}\n"));
}

TEST(Info, SampleMeansAreOverPointsAndGroupsSummed) {
  data::SceneSample sample = data::test::make_sample(4, 2, 2);
  sample.direct = {{1, 0, 0}, {3, 0, 0}, {10, 0, 0}, {20, 0, 0}};
  sample.variance = {0.04f, 0.12f};
  const Json info = sample_info(sample);
  EXPECT_EQ(info["kind"], "sample");
  EXPECT_EQ(info["query_points"], 2);
  EXPECT_FLOAT_EQ(info["mean_direct"][0].get<float>(), 17);
  EXPECT_NEAR(info["mean_standard_error"].get<double>(), std::sqrt(0.08), 1e-6);
  EXPECT_EQ(info["seed"], 0xffffffffffffffffULL);
}

class InfoOfDataset : public data::test::Folder {};

TEST_F(InfoOfDataset, CountsSplitsAndChecksFilesWhenDeep) {
  set_log_level(LogLevel::Quiet);
  GenerateOptions options;
  options.out = folder_ / "rooms";
  generate_dataset(tiny_config(), options);
  set_log_level(LogLevel::Info);
  const Json info = dataset_info(options.out, true);
  EXPECT_EQ(info["kind"], "dataset");
  EXPECT_EQ(info["scenes"], 5);
  EXPECT_EQ(info["splits"]["train"].get<int>() + info["splits"]["val"].get<int>() +
                info["splits"]["test"].get<int>(),
            5);
  EXPECT_EQ(info["query_points"], 5 * 48);
  const auto victim = data::scene_path(options.out, scene_name(GeneratorKind::Boxes, 2));
  std::filesystem::resize_file(victim, 100);
  EXPECT_EQ(dataset_info(options.out, false)["scenes"], 5);
  EXPECT_THAT(error_of([&] { dataset_info(options.out, true); }), HasSubstr(victim.string()));
}

}  // namespace
}  // namespace lte::datagen::test
