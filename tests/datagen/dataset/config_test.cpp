#include "datagen/dataset/config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/data/sample_fixture.h"
#include "tests/datagen/scenes.h"

namespace lte::datagen::test {
namespace {

using data::test::error_of;
using ::testing::AllOf;
using ::testing::HasSubstr;

std::string error_in(const std::string& yaml) {
  return error_of([&] { read_datagen_config(Config::parse(yaml, "test.yaml")); });
}

TEST(DatagenConfig, WrittenAndReadAgainIsTheSame) {
  const std::string text = to_yaml(tiny_config());
  EXPECT_EQ(to_yaml(read_datagen_config(Config::parse(text, "test.yaml"))), text);
  const std::string defaults = to_yaml(DatagenConfig{});
  EXPECT_EQ(to_yaml(read_datagen_config(Config::parse(defaults, "test.yaml"))), defaults);
  EXPECT_NE(defaults, text);
}

constexpr const char* kCommonKeys[] = {
    "scenes",       "seed",      "scale",    "val_share",     "test_share",   "evaluation_splits",
    "scene_points", "rays",      "min_rays", "query_points",  "target_error", "path_tracing_64",
    "max_rays",     "max_depth", "prune",    "emissive_share"};

TEST(DatagenConfig, ShippedFilesAreValidAndBoxesIsComplete) {
  const std::string folder = std::string(LTE_SOURCE_DIR) + "/configs/data/";
  const DatagenConfig rooms = load_datagen_config(folder + "boxes.yaml");
  EXPECT_EQ(rooms.generator, "boxes");
  EXPECT_EQ(rooms.bake.scene_points, 20000);
  EXPECT_EQ(rooms.bake.query_points, 100000);
  EXPECT_EQ(rooms.bake.rays, 1024);
  for (const char* child : {"rooms_small", "demo", "boxes_test", "shipped"}) {
    const DatagenConfig config = load_datagen_config(concat(folder, child, ".yaml"));
    EXPECT_EQ(config.generator, "boxes") << child;
    EXPECT_FALSE(config.bake.prune) << child;
  }
  EXPECT_EQ(load_datagen_config(folder + "rooms_small.yaml").bake.scene_points, 4096);
  EXPECT_EQ(load_datagen_config(folder + "demo.yaml").bake.scene_points, 2048);
  const Config yaml = Config::load(folder + "boxes.yaml");
  const Config all = Config::parse(to_yaml(rooms), "all");
  for (const char* key : kCommonKeys) EXPECT_TRUE(yaml.has(key)) << key;
  for (const char* key : {"count", "width", "height", "rays"})
    EXPECT_TRUE(yaml.at("views").has(key)) << key;
  for (const char* key : {"width_m", "depth_m", "height_m", "furniture", "lights", "radiance",
                          "two_room_share", "texture_sizes"}) {
    EXPECT_TRUE(yaml.at("rooms").has(key)) << key;
    EXPECT_TRUE(all.at("rooms").has(key)) << key;
  }
}

TEST(DatagenConfig, RoomsAreHomesAndNameEveryKey) {
  const std::string folder = std::string(LTE_SOURCE_DIR) + "/configs/data/";
  const DatagenConfig homes = load_datagen_config(folder + "rooms.yaml");
  EXPECT_EQ(homes.generator, "homes");
  EXPECT_TRUE(homes.bake.prune);
  const homes::HomeConfig defaults;
  EXPECT_EQ(homes.homes.rooms.high, defaults.rooms.high);
  EXPECT_EQ(homes.homes.detail.low, defaults.detail.low);
  EXPECT_EQ(homes.homes.detail.high, defaults.detail.high);
  const Config yaml = Config::load(folder + "rooms.yaml");
  for (const char* key : kCommonKeys) EXPECT_TRUE(yaml.has(key)) << key;
  for (const char* key : {"count", "width", "height", "rays"})
    EXPECT_TRUE(yaml.at("views").has(key)) << key;
  for (const char* key : {"rooms", "height_m", "detail", "radiance", "daylight_share", "lit_share",
                          "clutter", "texture_sizes"})
    EXPECT_TRUE(yaml.at("homes").has(key)) << key;
  const std::string text = to_yaml(homes);
  EXPECT_EQ(to_yaml(read_datagen_config(Config::parse(text, "test.yaml"))), text);
}

TEST(DatagenConfig, PaperHasThePapersCounts) {
  const DatagenConfig paper =
      load_datagen_config(std::string(LTE_SOURCE_DIR) + "/configs/data/paper.yaml");
  EXPECT_EQ(paper.generator, "homes");
  EXPECT_EQ(paper.scenes, 13900);
  EXPECT_EQ(paper.bake.scene_points, 20000);
  EXPECT_EQ(paper.bake.query_points, 2'000'000);
  EXPECT_EQ(paper.bake.rays, 1024);
  EXPECT_EQ(paper.bake.max_depth, 5);
}

TEST(DatagenConfig, BoxesAreWrittenWithoutAWordOfHomes) {
  const std::string boxes = to_yaml(DatagenConfig{});
  EXPECT_EQ(boxes.find("homes"), std::string::npos);
  EXPECT_EQ(boxes.find("generator"), std::string::npos);
  EXPECT_TRUE(boxes.starts_with("scenes: 1000\n"));
}

TEST(DatagenConfig, IncidentIsWrittenOnlyWhereItIsAskedFor) {
  DatagenConfig config;
  EXPECT_EQ(to_yaml(config).find("incident"), std::string::npos);
  config.bake.incident = {100, 16, 8};
  const std::string text = to_yaml(config);
  EXPECT_NE(text.find("incident:\n  points: 100\n  bins: 16\n  samples: 8\n"), std::string::npos);
  EXPECT_EQ(to_yaml(read_datagen_config(Config::parse(text, "test.yaml"))), text);
}

TEST(DatagenConfig, OverridesApply) {
  const std::string file = std::string(LTE_SOURCE_DIR) + "/configs/data/demo.yaml";
  const DatagenConfig config = load_datagen_config(file, {"views.rays=7", "rooms.lights=[2, 2]"});
  EXPECT_EQ(config.bake.views.rays, 7);
  EXPECT_EQ(config.rooms.lights.low, 2);
}

TEST(DatagenConfig, UnknownAndIllTypedKeysAreNamed) {
  EXPECT_THAT(error_in("scene_point: 3"), AllOf(HasSubstr("test.yaml"), HasSubstr("scene_points")));
  EXPECT_THAT(error_in("rooms: {width: [3, 4]}"), HasSubstr("width_m"));
  EXPECT_THAT(error_in("rays: many"), AllOf(HasSubstr("rays"), HasSubstr("many")));
  EXPECT_THAT(error_in("views: {rays: []}"), HasSubstr("views.rays"));
}

TEST(DatagenConfig, ValuesOutOfRangeAreNamed) {
  EXPECT_THAT(error_in("scenes: 0"), HasSubstr("scenes"));
  EXPECT_THAT(error_in("rays: 0"), HasSubstr("rays"));
  EXPECT_THAT(error_in("rooms: {height_m: [2, 3]}"), HasSubstr("rooms.height_m"));
  EXPECT_THAT(error_in("rooms: {width_m: [4, 3]}"), HasSubstr("rooms.width_m"));
  EXPECT_THAT(error_in("rooms: {width_m: [3, 4, 5]}"),
              AllOf(HasSubstr("rooms.width_m"), HasSubstr("3 numbers")));
  EXPECT_THAT(error_in("rooms: {lights: [0, 1]}"), HasSubstr("rooms.lights"));
  EXPECT_THAT(error_in("rooms: {texture_sizes: []}"), HasSubstr("rooms.texture_sizes"));
  EXPECT_THAT(error_in("incident: {points: -1}"), HasSubstr("incident.points"));
  EXPECT_THAT(error_in("incident: {bins: 5}"),
              AllOf(HasSubstr("incident.bins"), HasSubstr("even")));
  EXPECT_THAT(error_in("incident: {samples: 0}"), HasSubstr("incident.samples"));
  EXPECT_THAT(error_in("val_share: 0.6\ntest_share: 0.6"), HasSubstr("val_share"));
  EXPECT_THAT(error_in("evaluation_splits: [exam]"), HasSubstr("\"exam\""));
  EXPECT_THAT(error_in("generator: houses"), AllOf(HasSubstr("generator"), HasSubstr("homes")));
  EXPECT_THAT(error_in("generator: homes\nhomes: {rooms: [1, 7]}"), HasSubstr("homes.rooms"));
  EXPECT_THAT(error_in("generator: homes\nhomes: {detail: [0.1, 1]}"), HasSubstr("homes.detail"));
  EXPECT_THAT(error_in("generator: homes\nscale: 15"),
              AllOf(HasSubstr("scale"), HasSubstr("15.5")));
  EXPECT_THAT(error_in("homes: {room: [1, 2]}"), HasSubstr("rooms"));
  EXPECT_THAT(error_in("scale: 8"), AllOf(HasSubstr("scale"), HasSubstr("14.2")));
}

}  // namespace
}  // namespace lte::datagen::test
