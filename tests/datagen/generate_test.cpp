#include "datagen/generate.h"

#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/base/file.h"
#include "lte/base/log.h"
#include "lte/base/parallel.h"
#include "lte/data/dataset.h"
#include "lte/scene/load.h"
#include "tests/data/sample_fixture.h"
#include "tests/datagen/scenes.h"

namespace lte::datagen::test {
namespace {

using data::test::error_of;
using ::testing::AllOf;
using ::testing::HasSubstr;

class Generate : public data::test::Folder {
 protected:
  void SetUp() override {
    Folder::SetUp();
    set_log_level(LogLevel::Quiet);
  }
  void TearDown() override {
    set_log_level(LogLevel::Info);
    set_num_threads(0);
    Folder::TearDown();
  }

  GenerateResult generate(const std::string& out, const DatagenConfig& config = tiny_config(),
                          bool resume = false, int64_t shard = 0, int64_t shards = 1) const {
    GenerateOptions options;
    options.out = folder_ / out;
    options.resume = resume;
    options.shard_index = shard;
    options.shard_count = shards;
    return generate_dataset(config, options);
  }

  /// Relative path -> bytes of every file below.
  std::map<std::string, std::string> files(const std::string& out) const {
    std::map<std::string, std::string> all;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_ / out))
      if (entry.is_regular_file())
        all[std::filesystem::relative(entry.path(), folder_ / out).string()] =
            read_file(entry.path());
    return all;
  }
};

TEST_F(Generate, WritesADatasetThatReadsBack) {
  const DatagenConfig config = tiny_config();
  const GenerateResult result = generate("a", config);
  EXPECT_EQ(result.baked, 5);
  EXPECT_EQ(result.listed, 5);
  const data::DatasetInfo info = data::read_dataset_info(folder_ / "a");
  EXPECT_EQ(info.scale, 16.0);
  ASSERT_EQ(info.scenes.size(), 5u);
  for (size_t i = 0; i < 5; ++i) {
    const data::DatasetEntry& entry = info.scenes[i];
    EXPECT_EQ(entry.name, scene_name(static_cast<int64_t>(i)));
    EXPECT_EQ(entry.split, data::assign_split(config.seed, static_cast<int64_t>(i), 0.2, 0.2));
    const data::SceneSample sample =
        data::read_scene_sample(data::scene_path(folder_ / "a", entry.name));
    EXPECT_EQ(sample.seed, entry.seed);
    EXPECT_EQ(sample.scene_points(), entry.scene_points);
    EXPECT_EQ(sample.query_points(), entry.query_points);
    EXPECT_EQ(sample.views.size(), 1u);
  }
  EXPECT_EQ(files("a").size(), 7u);  // dataset.json, config.yaml, five scenes
}

TEST_F(Generate, SameBytesWhateverThreadsShardsAndInterruptions) {
  set_num_threads(1);
  generate("whole");
  const auto whole = files("whole");

  set_num_threads(3);
  generate("shards", tiny_config(), false, 1, 2);
  EXPECT_EQ(data::read_dataset_info(folder_ / "shards").scenes.size(), 2u);
  generate("shards", tiny_config(), false, 0, 2);
  EXPECT_EQ(files("shards"), whole);

  generate("resumed");
  std::filesystem::remove(data::scene_path(folder_ / "resumed", scene_name(1)));
  const auto cut = data::scene_path(folder_ / "resumed", scene_name(3));
  std::filesystem::resize_file(cut, std::filesystem::file_size(cut) / 2);
  std::filesystem::remove(folder_ / "resumed" / "dataset.json");
  const GenerateResult result = generate("resumed", tiny_config(), true);
  EXPECT_EQ(result.baked, 2);
  EXPECT_EQ(result.kept, 3);
  EXPECT_EQ(files("resumed"), whole);
}

TEST_F(Generate, AnotherSeedGivesOtherScenes) {
  DatagenConfig config = tiny_config();
  config.scenes = 1;
  generate("a", config);
  config.seed = 2;
  generate("b", config);
  EXPECT_NE(files("a").at("scenes/room_00000.safetensors"),
            files("b").at("scenes/room_00000.safetensors"));
}

TEST_F(Generate, ResumeAddsScenesAndNeverDropsAny) {
  DatagenConfig config = tiny_config();
  generate("whole", config);
  config.scenes = 2;
  generate("grown", config);
  config.scenes = 5;
  EXPECT_EQ(generate("grown", config, true).baked, 3);
  EXPECT_EQ(files("grown"), files("whole"));
  config.scenes = 2;
  const GenerateResult fewer = generate("grown", config, true);
  EXPECT_EQ(fewer.kept, 2);
  EXPECT_EQ(fewer.listed, 5);
  EXPECT_EQ(files("grown"), files("whole"));
}

TEST_F(Generate, EvaluationSplitsDecideWhoGetsViews) {
  DatagenConfig config = tiny_config();
  config.evaluation_splits = {"test"};
  generate("a", config);
  size_t with = 0, without = 0;
  for (const data::DatasetEntry& entry : data::read_dataset_info(folder_ / "a").scenes) {
    const data::SceneSample sample =
        data::read_scene_sample(data::scene_path(folder_ / "a", entry.name));
    const bool test = entry.split == data::Split::Test;
    EXPECT_EQ(sample.views.size(), test ? 1u : 0u);
    EXPECT_EQ(sample.path_traced_64.empty(), !test);
    ++(test ? with : without);
  }
  EXPECT_GT(with, 0u);
  EXPECT_GT(without, 0u);
}

TEST_F(Generate, GlbIsTheSceneThatWasBaked) {
  DatagenConfig config = tiny_config();
  config.scenes = 1;
  GenerateOptions options;
  options.out = folder_ / "a";
  options.glb = true;
  generate_dataset(config, options);
  const scene::Scene loaded = scene::load_scene(folder_ / "a" / "scenes" / "room_00000.glb");
  const Room room = generate_room(config.rooms, scene_seed(config.seed, 0));
  EXPECT_EQ(loaded.triangle_count(), room.scene.triangle_count());
  EXPECT_EQ(loaded.light_groups.size(), room.scene.light_groups.size());
  const Vec3 difference = loaded.bounds().high - room.scene.bounds().high;
  EXPECT_LT(length(difference), 1e-4f);
  EXPECT_EQ(loaded.cameras.size(), 1u);
}

TEST_F(Generate, HomesAreTheSameBytesAndAnotherConfigurationIsRefused) {
  DatagenConfig config = tiny_config();
  config.generator = "homes";
  config.scenes = 2;
  config.homes.rooms = {1, 2};
  config.homes.detail = {0.3, 0.3};
  config.homes.texture_sizes = {8};
  set_num_threads(1);
  generate("a", config);
  set_num_threads(3);
  generate("b", config);
  EXPECT_EQ(files("a"), files("b"));
  config.homes.clutter = 0;
  EXPECT_THAT(error_of([&] { generate("a", config, true); }), HasSubstr("clutter"));
  config.generator = "boxes";
  EXPECT_THAT(error_of([&] { generate("a", config, true); }), HasSubstr("generator: \"homes\""));
}

TEST_F(Generate, RefusesForeignUsedAndDifferentDirectories) {
  std::filesystem::create_directories(folder_ / "photos");
  write_file(folder_ / "photos" / "cat.jpg", "meow");
  EXPECT_THAT(error_of([&] { generate("photos"); }),
              AllOf(HasSubstr("photos"), HasSubstr("not a data set")));
  EXPECT_THAT(error_of([&] { generate("photos", tiny_config(), true); }),
              HasSubstr("not a data set"));
  EXPECT_THAT(error_of([&] { generate("photos/cat.jpg"); }), HasSubstr("not a directory"));
  EXPECT_THAT(error_of([&] { generate("photos/cat.jpg/deeper"); }),
              HasSubstr("cannot make the directory"));
  EXPECT_EQ(files("photos").size(), 1u);

  DatagenConfig config = tiny_config();
  config.scenes = 1;
  generate("used", config);
  EXPECT_THAT(error_of([&] { generate("used", config); }), HasSubstr("--resume"));
  config.bake.rays = 9;
  EXPECT_THAT(error_of([&] { generate("used", config, true); }),
              AllOf(HasSubstr("rays: 8 there"), HasSubstr("rays: 9 now")));
}

TEST_F(Generate, BadShardsAreRefused) {
  EXPECT_THAT(error_of([&] { generate("a", tiny_config(), false, 2, 2); }), HasSubstr("--shard"));
  EXPECT_THAT(error_of([&] { generate("a", tiny_config(), false, -1, 2); }), HasSubstr("--shard"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "a"));
}

}  // namespace
}  // namespace lte::datagen::test
