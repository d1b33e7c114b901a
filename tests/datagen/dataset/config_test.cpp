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
    "scenes",       "seed",      "scale",    "val_share",      "test_share",   "evaluation_splits",
    "scene_points", "rays",      "min_rays", "query_points",   "target_error", "path_tracing_64",
    "max_rays",     "max_depth", "prune",    "emissive_share", "light_paths"};

DatagenConfig shipped(const std::string& name) {
  return load_datagen_config(concat(LTE_SOURCE_DIR, "/configs/data/", name, ".yaml"));
}

/// The keys of a shipped file, its parents' included.
Config shipped_yaml(const std::string& name) {
  return Config::load(concat(LTE_SOURCE_DIR, "/configs/data/", name, ".yaml"));
}

TEST(DatagenConfig, BaseNamesEveryKeyThatBoxesAndHomesShare) {
  const Config yaml = shipped_yaml("base");
  for (const char* key : kCommonKeys) EXPECT_TRUE(yaml.has(key)) << key;
  for (const char* key : {"count", "width", "height", "rays"})
    EXPECT_TRUE(yaml.at("views").has(key)) << key;
  for (const char* key : {"points", "bins", "samples"})
    EXPECT_TRUE(yaml.at("incident").has(key)) << key;
  for (const char* key : {"share", "roughness"}) EXPECT_TRUE(yaml.at("metals").has(key)) << key;
  for (const char* key : {"boxes", "homes", "generator"}) EXPECT_FALSE(yaml.has(key)) << key;
}

TEST(DatagenConfig, ShippedFilesOfBoxesAreValidAndNameEveryKey) {
  const DatagenConfig boxes = shipped("boxes");
  EXPECT_EQ(boxes.generator, GeneratorKind::Boxes);
  EXPECT_EQ(boxes.bake.scene_points, 20000);
  EXPECT_EQ(boxes.bake.query_points, 100000);
  EXPECT_EQ(boxes.bake.rays, 1024);
  for (const char* child : {"boxes_small", "demo", "boxes_test"}) {
    const DatagenConfig config = shipped(child);
    EXPECT_EQ(config.generator, GeneratorKind::Boxes) << child;
    EXPECT_FALSE(config.bake.prune) << child;
  }
  EXPECT_EQ(shipped("boxes_small").bake.scene_points, 4096);
  EXPECT_EQ(shipped("demo").bake.scene_points, 2048);
  const Config yaml = shipped_yaml("boxes");
  const Config all = Config::parse(to_yaml(boxes), "all");
  for (const char* key : kCommonKeys) EXPECT_TRUE(yaml.has(key)) << key;
  for (const char* key : {"width_m", "depth_m", "height_m", "furniture", "lights", "radiance",
                          "two_room_share", "open_share", "size_factor", "texture_sizes"}) {
    EXPECT_TRUE(yaml.at("boxes").has(key)) << key;
    EXPECT_TRUE(all.at("boxes").has(key)) << key;
  }
}

TEST(DatagenConfig, GlossyFilesHaveMetalsAndMaps) {
  for (const char* name : {"glossy", "glossy_test"}) {
    const DatagenConfig config = shipped(name);
    EXPECT_GT(config.metals.share, 0) << name;
    EXPECT_EQ(config.metals.roughness.low, 0.05) << name;
    EXPECT_EQ(config.metals.roughness.high, 0.5) << name;
    EXPECT_GT(config.bake.incident.points, 0) << name;
    EXPECT_EQ(config.bake.incident.bins, 32) << name;
    EXPECT_TRUE(config.bake.prune) << name;
  }
  EXPECT_EQ(shipped("glossy_test").bake.incident.samples, 64);
  EXPECT_EQ(shipped("glossy_test").test_share, 1);
}

TEST(DatagenConfig, ShippedFilesOfHomesAreValidAndNameEveryKey) {
  const DatagenConfig homes = shipped("homes");
  for (const char* child : {"homes", "homes_small", "homes_test", "paper"}) {
    const DatagenConfig config = shipped(child);
    EXPECT_EQ(config.generator, GeneratorKind::Homes) << child;
    EXPECT_TRUE(config.bake.prune) << child;
  }
  const homes::HomeConfig defaults;
  EXPECT_EQ(homes.homes.rooms.high, defaults.rooms.high);
  EXPECT_EQ(homes.homes.detail.low, defaults.detail.low);
  EXPECT_EQ(homes.homes.detail.high, defaults.detail.high);
  const Config yaml = shipped_yaml("homes");
  for (const char* key : kCommonKeys) EXPECT_TRUE(yaml.has(key)) << key;
  for (const char* key : {"rooms", "height_m", "detail", "radiance", "daylight_share", "sun_share",
                          "lit_share", "clutter", "texture_sizes"})
    EXPECT_TRUE(yaml.at("homes").has(key)) << key;
  const std::string text = to_yaml(homes);
  EXPECT_EQ(to_yaml(read_datagen_config(Config::parse(text, "test.yaml"))), text);
}

TEST(DatagenConfig, ShippedFilesOfWildRoomsAreValidAndNameEveryKey) {
  for (const char* name : {"wild", "wild_test", "mixed", "mixed_paper"}) {
    const DatagenConfig config = shipped(name);
    const Config yaml = shipped_yaml(name);
    EXPECT_TRUE(config.bake.prune) << name;
    EXPECT_TRUE(config.makes(GeneratorKind::Wild)) << name;
    for (const char* key : kCommonKeys) EXPECT_TRUE(yaml.has(key)) << key;
    for (const char* key : {"cells", "extent_m", "lamps", "sky_share", "detail", "texture_sizes"})
      EXPECT_TRUE(yaml.at("wild").has(key)) << key;
    const std::string text = to_yaml(config);
    EXPECT_EQ(to_yaml(read_datagen_config(Config::parse(text, "test.yaml"))), text);
  }
  EXPECT_NE(shipped("wild").seed, shipped("wild_test").seed);
  EXPECT_EQ(shipped("wild_test").test_share, 1);
  const DatagenConfig mixed = shipped("mixed");
  EXPECT_TRUE(mixed.makes(GeneratorKind::Homes) && mixed.makes(GeneratorKind::Boxes));
  EXPECT_EQ(shipped("mixed_paper").seed, mixed.seed) << "the same rooms";
  EXPECT_THAT(error_in("generator: wold"),
              HasSubstr("expected boxes, homes, wild, mixed or files"));
  EXPECT_THAT(error_in("generator: wild\nwild: {cells: [1, 6]}"), HasSubstr("wild.cells"));
  EXPECT_THAT(error_in("generator: wild\nwild: {extent_m: [2, 20]}"), HasSubstr("wild.extent_m"));
  EXPECT_THAT(error_in("generator: wild\nwild: {extend_m: [2, 3]}"), HasSubstr("extend_m"));
  EXPECT_THAT(error_in("generator: mixed\nmixed: {boxes: 0, homes: 0, wild: 0}"),
              HasSubstr("mixed"));
}

TEST(DatagenConfig, ScenesOfFilesNameTheirFolderAndStayAsTheyAre) {
  EXPECT_THAT(error_in("generator: files"), HasSubstr("files.folder"));
  const std::string files = "generator: files\nfiles: {folder: a}\n";
  EXPECT_THAT(error_in(files + "metals: {share: 0.5}"), HasSubstr("metals.share"));
  EXPECT_THAT(error_in(files + "sides: {two_sided_share: 0.5}"), HasSubstr("two_sided_share"));
  EXPECT_THAT(error_in(files + "sides: {flipped_share: 0.5}"), HasSubstr("flipped_share"));
  const DatagenConfig config =
      load_datagen_config(concat(LTE_SOURCE_DIR, "/configs/data/files.yaml"), {"files.folder=a b"});
  EXPECT_EQ(config.generator, GeneratorKind::Files);
  EXPECT_EQ(config.files.folder, "a b");
  const std::string text = to_yaml(config);
  EXPECT_EQ(to_yaml(read_datagen_config(Config::parse(text, "test.yaml"))), text);
}

TEST(DatagenConfig, FormerNamesAreRead) {
  DatagenConfig config = read_datagen_config(
      Config::parse("boxes: {lights: [1, 1], furniture: [2, 3]}\nrooms: {lights: [2, 2]}", "test"));
  EXPECT_EQ(config.boxes.lights.low, 2) << "a child's `rooms:` goes before its parent's `boxes:`";
  EXPECT_EQ(config.boxes.furniture.high, 3);
  const DatagenConfig boxes;  // as an older version wrote it, without a generator
  std::string text = to_yaml(boxes);
  text.erase(0, text.find('\n') + 1);
  text.replace(text.find("boxes:"), 6, "rooms:");
  EXPECT_EQ(to_yaml(read_datagen_config(Config::parse(text, "test"))), to_yaml(boxes));
}

TEST(DatagenConfig, PaperHasThePapersCounts) {
  const DatagenConfig paper = shipped("paper");
  EXPECT_EQ(paper.generator, GeneratorKind::Homes);
  EXPECT_EQ(paper.scenes, 13900);
  EXPECT_EQ(paper.bake.scene_points, 20000);
  EXPECT_EQ(paper.bake.query_points, 2'000'000);
  EXPECT_EQ(paper.bake.rays, 1024);
  EXPECT_EQ(paper.bake.max_depth, 5);
}

TEST(DatagenConfig, OnlyTheGeneratorInUseIsWritten) {
  DatagenConfig config;
  EXPECT_TRUE(to_yaml(config).starts_with("generator: \"boxes\"\nscenes: 1000\n"));
  EXPECT_EQ(to_yaml(config).find("homes"), std::string::npos);
  config.generator = GeneratorKind::Homes;
  EXPECT_TRUE(to_yaml(config).starts_with("generator: \"homes\"\nscenes: 1000\n"));
  EXPECT_EQ(to_yaml(config).find("boxes"), std::string::npos);
}

TEST(DatagenConfig, IncidentIsWrittenOnlyWhereItIsAskedFor) {
  DatagenConfig config;
  EXPECT_EQ(to_yaml(config).find("incident"), std::string::npos);
  config.bake.incident = {100, 16, 8};
  const std::string text = to_yaml(config);
  EXPECT_NE(text.find("incident:\n  points: 100\n  bins: 16\n  samples: 8\n"), std::string::npos);
  EXPECT_EQ(to_yaml(read_datagen_config(Config::parse(text, "test.yaml"))), text);
}

TEST(DatagenConfig, SunsAreWrittenOnlyWhereThereAreAny) {
  EXPECT_EQ(to_yaml(shipped("homes")).find("sun_share"), std::string::npos);
  const DatagenConfig suns = shipped("homes_daylight");
  EXPECT_EQ(suns.homes.sun_share, 0.8);
  const std::string text = to_yaml(suns);
  EXPECT_NE(text.find("  sun_share: 0.8\n"), std::string::npos);
  EXPECT_EQ(to_yaml(read_datagen_config(Config::parse(text, "test.yaml"))), text);
  EXPECT_THAT(error_in("generator: homes\nhomes: {sun_share: 2}"), HasSubstr("homes.sun_share"));
  EXPECT_THAT(error_in("generator: homes\nhomes: {sky_picture_share: 2}"),
              HasSubstr("homes.sky_picture_share"));
  // The sphere around the largest home is wider than the home.
  EXPECT_THAT(error_in("generator: homes\nhomes: {sun_share: 0.5}"),
              AllOf(HasSubstr("scale: 16"), HasSubstr("sun_share")));
  EXPECT_EQ(error_in("generator: homes\nhomes: {sun_share: 0.5, rooms: [1, 2]}"), "");
}

TEST(DatagenConfig, OverridesApply) {
  const std::string file = std::string(LTE_SOURCE_DIR) + "/configs/data/demo.yaml";
  const DatagenConfig config = load_datagen_config(file, {"views.rays=7", "boxes.lights=[2, 2]"});
  EXPECT_EQ(config.bake.views.rays, 7);
  EXPECT_EQ(config.boxes.lights.low, 2);
}

TEST(DatagenConfig, UnknownAndIllTypedKeysAreNamed) {
  EXPECT_THAT(error_in("scene_point: 3"), AllOf(HasSubstr("test.yaml"), HasSubstr("scene_points")));
  EXPECT_THAT(error_in("boxes: {width: [3, 4]}"), HasSubstr("width_m"));
  EXPECT_THAT(error_in("rays: many"), AllOf(HasSubstr("rays"), HasSubstr("many")));
  EXPECT_THAT(error_in("views: {rays: []}"), HasSubstr("views.rays"));
}

TEST(DatagenConfig, ValuesOutOfRangeAreNamed) {
  EXPECT_THAT(error_in("scenes: 0"), HasSubstr("scenes"));
  EXPECT_THAT(error_in("rays: 0"), HasSubstr("rays"));
  EXPECT_THAT(error_in("boxes: {height_m: [2, 3]}"), HasSubstr("boxes.height_m"));
  EXPECT_THAT(error_in("boxes: {width_m: [4, 3]}"), HasSubstr("boxes.width_m"));
  EXPECT_THAT(error_in("boxes: {width_m: [3, 4, 5]}"),
              AllOf(HasSubstr("boxes.width_m"), HasSubstr("3 numbers")));
  EXPECT_THAT(error_in("boxes: {lights: [0, 1]}"), HasSubstr("boxes.lights"));
  EXPECT_THAT(error_in("boxes: {open_share: 1.5}"), HasSubstr("boxes.open_share"));
  EXPECT_THAT(error_in("boxes: {sky_share: -1}"), HasSubstr("boxes.sky_share"));
  EXPECT_THAT(error_in("boxes: {shut_sky_share: 2}"), HasSubstr("boxes.shut_sky_share"));
  EXPECT_THAT(error_in("boxes: {shut_sky_share: 0.5}"), HasSubstr("scale: 16"));
  EXPECT_THAT(error_in("boxes: {sky_picture_share: 1.5}"), HasSubstr("boxes.sky_picture_share"));
  EXPECT_THAT(error_in("boxes: {sky_share: 0.5}"),
              AllOf(HasSubstr("scale: 16"), HasSubstr("sky_share")));
  EXPECT_EQ(error_in("boxes: {sky_share: 0.5, width_m: [3, 4]}"), "");
  EXPECT_THAT(error_in("boxes: {size_factor: [0, 1]}"), HasSubstr("boxes.size_factor"));
  EXPECT_THAT(error_in("boxes: {size_factor: [1, 2]}"),
              AllOf(HasSubstr("scale"), HasSubstr("28.4")));
  EXPECT_THAT(error_in("boxes: {texture_sizes: []}"), HasSubstr("boxes.texture_sizes"));
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
