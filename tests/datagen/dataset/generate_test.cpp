#include "datagen/dataset/generate.h"

#include <chrono>
#include <fstream>
#include <map>
#include <optional>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "lte/base/file.h"
#include "lte/base/log.h"
#include "lte/base/parallel.h"
#include "lte/data/dataset.h"
#include "tests/data/sample_fixture.h"
#include "tests/datagen/dataset/generate_fixture.h"
#include "tests/datagen/scenes.h"
#include "tests/support/every_light.h"
#include "tests/support/file_limit.h"

namespace lte::datagen::test {
namespace {

using data::test::error_of;
using ::testing::AllOf;
using ::testing::HasSubstr;

std::string box_name(int64_t index) { return scene_name(GeneratorKind::Boxes, index); }

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
    EXPECT_EQ(entry.name, box_name(static_cast<int64_t>(i)));
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
  const GenerateResult first = generate("shards", tiny_config(), false, 1, 2);
  EXPECT_EQ(first.missing, 3);
  EXPECT_EQ(first.listed, 0);
  EXPECT_THAT(error_of([&] { data::read_dataset_info(folder_ / "shards"); }),
              HasSubstr("unfinished"));
  EXPECT_EQ(generate("shards", tiny_config(), false, 0, 2).listed, 5);
  EXPECT_EQ(files("shards"), whole);

  generate("resumed");
  std::filesystem::remove(data::scene_path(folder_ / "resumed", box_name(1)));
  const auto cut = data::scene_path(folder_ / "resumed", box_name(3));
  std::filesystem::resize_file(cut, std::filesystem::file_size(cut) / 2);
  std::filesystem::remove(folder_ / "resumed" / "dataset.json");
  const GenerateResult result = generate("resumed", tiny_config(), true);
  EXPECT_EQ(result.baked, 2);
  EXPECT_EQ(result.kept, 3);
  EXPECT_EQ(files("resumed"), whole);
}

TEST_F(Generate, ThreeShardsInAnyOrderAreTheWholeByteForByte) {
  generate("whole");
  for (const int threads : {1, 2}) {
    set_num_threads(threads);
    const std::string out = concat("cut_", threads);
    for (const int64_t shard : {2, 0, 1}) {
      EXPECT_FALSE(std::filesystem::exists(folder_ / out / "dataset.json"));
      generate(out, tiny_config(), true, shard, 3);
    }
    EXPECT_EQ(files(out), files("whole")) << threads;
    const std::string folder = (folder_ / out / "manifest").string();
    for (const int shard : {0, 1, 2})
      EXPECT_TRUE(std::filesystem::exists(concat(folder, "/shard_", shard, "_of_3.jsonl")));
  }
}

TEST_F(Generate, MergeListsWhatIsThereAndSaysWhatIsNot) {
  generate("whole");
  generate("part", tiny_config(), false, 0, 2);
  const GenerateResult part = merge_dataset(folder_ / "part");
  EXPECT_EQ(part.listed, 3);
  EXPECT_EQ(part.missing, 2);
  const data::DatasetInfo info = data::read_dataset_info(folder_ / "part");
  EXPECT_EQ(info.planned, 5);
  EXPECT_EQ(info.scenes.size(), 3u);
  generate("part", tiny_config(), false, 1, 2);
  EXPECT_EQ(files("part"), files("whole"));
  std::filesystem::remove(folder_ / "part" / "dataset.json");
  EXPECT_EQ(merge_dataset(folder_ / "part").missing, 0);
  EXPECT_EQ(files("part"), files("whole"));
  std::filesystem::create_directories(folder_ / "empty");
  EXPECT_THAT(error_of([&] { merge_dataset(folder_ / "empty"); }), HasSubstr("config.yaml"));
}

TEST_F(Generate, ManifestSaysWhatWasDoneAndWhatItTook) {
  const DatagenConfig config = tiny_config();
  generate("a", config, false, 1, 2);
  generate("a", config, true, 1, 2);
  std::istringstream lines(read_file(folder_ / "a" / "manifest" / "shard_1_of_2.jsonl"));
  std::vector<nlohmann::json> runs, scenes, ends;
  for (std::string line; std::getline(lines, line);) {
    const nlohmann::json json = nlohmann::json::parse(line);
    (json["type"] == "run" ? runs : json["type"] == "scene" ? scenes : ends).push_back(json);
  }
  ASSERT_EQ(runs.size(), 2u);
  EXPECT_EQ(runs[0]["config"], to_yaml(config));
  EXPECT_EQ(runs[0]["shard"], nlohmann::json({1, 2}));
  for (const char* key : {"tool", "host", "threads", "seed", "time", "pid"})
    EXPECT_TRUE(runs[0].contains(key)) << key;
  ASSERT_EQ(scenes.size(), 2u);  // the second run kept both
  const data::SceneSample sample =
      data::read_scene_sample(data::scene_path(folder_ / "a", box_name(1)));
  const scene::Scene scene = generate_scene(config, scene_seed(config.seed, 1), "x");
  EXPECT_EQ(scenes[0]["name"], box_name(1));
  EXPECT_EQ(scenes[0]["seed"], scene_seed(config.seed, 1));
  EXPECT_EQ(scenes[0]["triangles"], scene.triangle_count());
  EXPECT_EQ(scenes[0]["bytes"],
            std::filesystem::file_size(data::scene_path(folder_ / "a", box_name(1))));
  // 48 query points and one view of 8 x 6 pixels, all of which meet a wall; each with 8 paths and
  // 64 of path_traced_64, pixels with 16, 4 and 1 too.
  EXPECT_EQ(scenes[0]["rays"], (48 + 8 * 6) * (8 + 64) + 8 * 6 * (16 + 4 + 1));
  EXPECT_GE(scenes[0]["seconds"], scenes[0]["bake_seconds"]);
  ASSERT_EQ(ends.size(), 2u);
  EXPECT_EQ(ends[0]["baked"], 2);
  EXPECT_EQ(ends[1]["kept"], 2);
}

TEST_F(Generate, AFailedSceneIsWrittenDownLeftOutAndTriedAgain) {
  const DatagenConfig config = tiny_config();
  generate("whole", config);
  bool broken = true;
  const SceneMaker maker = [&](int64_t index, const std::string& name) {
    LTE_CHECK(!broken || name != "box_00003", "the roof fell in");
    return generate_scene(config, scene_seed(config.seed, index), name);
  };
  GenerateOptions options;
  options.out = folder_ / "a";
  const GenerateResult result = generate_dataset(config, options, maker);
  EXPECT_EQ(result.baked, 4);
  EXPECT_EQ(result.failed, 1);
  EXPECT_EQ(result.missing, 0);
  EXPECT_EQ(result.first_error, "box_00003: the roof fell in");
  const data::DatasetInfo info = data::read_dataset_info(folder_ / "a");
  EXPECT_EQ(info.scenes.size(), 4u);
  EXPECT_EQ(info.planned, 5);
  const SceneRecords records = read_manifests(folder_ / "a");
  EXPECT_EQ(records.at(3).error, "the roof fell in");
  EXPECT_EQ(records.at(2).error, "");
  EXPECT_EQ(merge_dataset(folder_ / "a").failed, 1);

  options.resume = options.strict = true;
  EXPECT_THAT(error_of([&] { generate_dataset(config, options, maker); }),
              AllOf(HasSubstr("the roof fell in"), HasSubstr("--strict")));
  broken = false;
  EXPECT_EQ(generate_dataset(config, options, maker).baked, 1);
  EXPECT_EQ(files("a"), files("whole"));
}

TEST_F(Generate, FailuresInARowEndTheRun) {
  DatagenConfig config = tiny_config();
  config.scenes = 3 * kFailuresInARow;
  int calls = 0;
  const SceneMaker maker = [&](int64_t, const std::string&) -> scene::Scene {
    ++calls;
    throw Error("no power");
  };
  GenerateOptions options;
  options.out = folder_ / "a";
  EXPECT_THAT(error_of([&] { generate_dataset(config, options, maker); }),
              AllOf(HasSubstr("no power"), HasSubstr("in a row")));
  EXPECT_EQ(calls, kFailuresInARow);
}

TEST_F(Generate, AFullDiskEndsTheRunAtOnceAndResumeGoesOn) {
  DatagenConfig config = tiny_config();
  generate("whole", config);
  const auto size = std::filesystem::file_size(data::scene_path(folder_ / "whole", box_name(2)));
  // The disk fills up while the third scene is in work.
  int calls = 0;
  std::optional<lte::test::FileLimit> full;
  const SceneMaker maker = [&](int64_t index, const std::string& name) {
    if (++calls == 3) full.emplace(size / 2);
    return generate_scene(config, scene_seed(config.seed, index), name);
  };
  GenerateOptions options;
  options.out = folder_ / "a";
  const std::string said = error_of([&] { generate_dataset(config, options, maker); });
  full.reset();
  EXPECT_EQ(calls, 3) << "the scenes behind it are not tried";
  EXPECT_THAT(said,
              AllOf(HasSubstr("box_00002"), HasSubstr("File too large"), HasSubstr("--resume")));
  EXPECT_EQ(said.find('\n'), std::string::npos);
  EXPECT_TRUE(read_manifests(options.out).at(1).error.empty());
  EXPECT_FALSE(read_manifests(options.out).contains(2));
  EXPECT_EQ(generate("a", config, true).kept, 2);
  EXPECT_EQ(files("a"), files("whole"));
}

TEST_F(Generate, LeftoversOfKilledRunsGoAndThoseOfOthersStay) {
  generate("a", tiny_config(), false, 0, 2);
  const auto put = [&](const std::string& name) {
    write_file(folder_ / "a" / name, "half");
    return folder_ / "a" / name;
  };
  const auto own = put("scenes/.box_00002.safetensors.tmp-4711-1-0"),
             other = put("scenes/.box_00003.safetensors.tmp-4711-1-0"),
             fresh = put(".dataset.json.tmp-4711-1-1"), old = put(".config.yaml.tmp-4711-1-2");
  std::filesystem::last_write_time(old,
                                   std::filesystem::last_write_time(old) - std::chrono::hours(2));
  {  // and a manifest whose last line was cut short
    std::ofstream manifest(folder_ / "a" / "manifest" / "shard_0_of_2.jsonl", std::ios::app);
    manifest << R"({"type":"scene","na)";
  }
  EXPECT_EQ(generate("a", tiny_config(), true, 0, 2).kept, 3);
  EXPECT_FALSE(std::filesystem::exists(own));
  EXPECT_FALSE(std::filesystem::exists(old));
  EXPECT_TRUE(std::filesystem::exists(other));
  EXPECT_TRUE(std::filesystem::exists(fresh));
  EXPECT_EQ(read_manifests(folder_ / "a").size(), 3u);
}

TEST_F(Generate, TwoProcessesNeverWorkOnOneShardOrOnTwoCuts) {
  generate("a", tiny_config(), false, 0, 2);
  const Manifest at_work(folder_ / "a", {1, 2});
  EXPECT_THAT(error_of([&] { generate("a", tiny_config(), true, 1, 2); }),
              AllOf(HasSubstr("shard_1_of_2"), HasSubstr("another process")));
  EXPECT_THAT(error_of([&] { generate("a", tiny_config(), true); }), HasSubstr("another number"));
  EXPECT_THAT(error_of([&] { generate("a", tiny_config(), true, 1, 3); }),
              HasSubstr("shard_1_of_2"));
  EXPECT_EQ(generate("a", tiny_config(), true, 0, 2).kept, 3);
}

TEST_F(Generate, PrunedSetsSayIt) {
  DatagenConfig config = tiny_config();
  config.scenes = 1;
  generate("all", config);
  EXPECT_FALSE(data::read_dataset_info(folder_ / "all").pruned);
  config.bake.prune = true;
  generate("reached", config);
  EXPECT_TRUE(data::read_dataset_info(folder_ / "reached").pruned);
}

/// Rooms with a point light in front of each of their corners, pruned.
TEST_F(Generate, PrunedSetsKeepEveryPointLight) {
  DatagenConfig config = tiny_config();
  config.scenes = 4;
  config.bake.prune = true;
  GenerateOptions options;
  options.out = folder_ / "lit";
  generate_dataset(config, options, [](int64_t index, const std::string& name) {
    scene::Scene scene = lte::test::dark_room();
    scene.name = name;
    for (int64_t i = 0; i < 1 + 2 * index; ++i)
      lte::test::add_point_light(&scene, {0.3f, 0.3f + 0.2f * static_cast<float>(i), 0.3f},
                                 {1, 1, 1});
    return scene;
  });
  const data::DatasetInfo info = data::read_dataset_info(folder_ / "lit");
  ASSERT_EQ(info.scenes.size(), 4u);
  for (int64_t scene = 0; scene < 4; ++scene) {
    const data::SceneSample sample =
        data::read_scene_sample(data::scene_path(folder_ / "lit", box_name(scene)));
    ASSERT_EQ(sample.light_groups, 1 + 2 * scene);
    std::vector<double> strength(static_cast<size_t>(sample.light_groups), 0.0);
    for (size_t i = 0; i < sample.scene_light.size(); ++i)
      if (sample.scene_light[i] >= 0)
        strength[static_cast<size_t>(sample.scene_light[i])] +=
            double{sample.scene_emission[i].x} * sample.scene_area[i];
    for (const double found : strength) EXPECT_NEAR(found, 4, 1e-4);
  }
}

TEST_F(Generate, AnotherSeedGivesOtherScenes) {
  DatagenConfig config = tiny_config();
  config.scenes = 1;
  generate("a", config);
  config.seed = 2;
  generate("b", config);
  EXPECT_NE(files("a").at("scenes/box_00000.safetensors"),
            files("b").at("scenes/box_00000.safetensors"));
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

/// The data set in `folder` as it would be if an older version had made it: scenes are room_00042,
/// and the configuration has them under `rooms:` and names no generator.
void make_older(const std::filesystem::path& folder) {
  std::string index = read_file(folder / "dataset.json");
  for (const auto& entry : std::filesystem::directory_iterator(folder / "scenes")) {
    const std::string file = entry.path().filename().string();
    std::filesystem::rename(entry.path(), folder / "scenes" / ("room_" + file.substr(4)));
    const std::string name = file.substr(0, 9);
    index.replace(index.find(name), name.size(), "room_" + name.substr(4));
  }
  write_file(folder / "dataset.json", index);
  std::string config = read_file(folder / "config.yaml");
  config.erase(0, config.find('\n') + 1);
  config.replace(config.find("boxes:"), 6, "rooms:");
  write_file(folder / "config.yaml", config);
}

TEST_F(Generate, AnOlderDataSetGoesOnWithTheNamesThatItHas) {
  DatagenConfig config = tiny_config();
  generate("whole", config);
  config.scenes = 2;
  generate("older", config);
  std::filesystem::remove_all(folder_ / "older" / "manifest");
  make_older(folder_ / "older");
  EXPECT_EQ(merge_dataset(folder_ / "older").listed, 2);
  config.scenes = 5;
  const GenerateResult grown = generate("older", config, true);
  EXPECT_EQ(grown.kept, 2);
  EXPECT_EQ(grown.baked, 3);
  EXPECT_EQ(grown.listed, 5);
  const data::DatasetInfo info = data::read_dataset_info(folder_ / "older");
  ASSERT_EQ(info.scenes.size(), 5u);
  for (int64_t i = 0; i < 5; ++i) {
    const data::DatasetEntry& entry = info.scenes[static_cast<size_t>(i)];
    EXPECT_EQ(entry.name, concat("room_0000", i));
    const data::SceneSample sample =
        data::read_scene_sample(data::scene_path(folder_ / "older", entry.name));
    const data::SceneSample same =
        data::read_scene_sample(data::scene_path(folder_ / "whole", box_name(i)));
    EXPECT_EQ(sample.seed, same.seed) << "seeds do not depend on names";
    EXPECT_EQ(floats(sample.indirect), floats(same.indirect));
  }
}

TEST_F(Generate, ScenesAreNamedAfterTheirGenerator) {
  EXPECT_EQ(scene_name(GeneratorKind::Homes, 42), "home_00042");
  EXPECT_EQ(scene_name(GeneratorKind::Boxes, 42), "box_00042");
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

TEST_F(Generate, HomesAreTheSameBytesAndAnotherConfigurationIsRefused) {
  DatagenConfig config = tiny_config();
  config.generator = GeneratorKind::Homes;
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
  config.generator = GeneratorKind::Boxes;
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

TEST_F(Generate, MixedScenesComeFromAllGeneratorsInTheirShares) {
  DatagenConfig config = tiny_config();
  config.generator = GeneratorKind::Mixed;
  config.mixed = {.boxes = 1, .homes = 1, .wild = 2};
  std::map<GeneratorKind, int> counts;
  for (uint64_t seed = 0; seed < 4000; ++seed) ++counts[generator_of(config, seed)];
  EXPECT_EQ(counts.size(), 3u);
  EXPECT_NEAR(counts[GeneratorKind::Wild], 2000, 100);
  EXPECT_NEAR(counts[GeneratorKind::Homes], 1000, 90);
  config.mixed = {.boxes = 1, .homes = 0, .wild = 1};
  config.wild.texture_sizes = {8};
  config.scenes = 4;
  generate("mixed", config);
  const data::DatasetInfo info = data::read_dataset_info(folder_ / "mixed");
  EXPECT_EQ(info.scenes.size(), 4u);
  EXPECT_EQ(info.scenes[0].name, "scene_00000");
  EXPECT_TRUE(info.suns) << "skies of wild rooms";
}

TEST_F(Generate, BadShardsAreRefused) {
  EXPECT_THAT(error_of([&] { generate("a", tiny_config(), false, 2, 2); }), HasSubstr("--shard"));
  EXPECT_THAT(error_of([&] { generate("a", tiny_config(), false, -1, 2); }), HasSubstr("--shard"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "a"));
}

}  // namespace
}  // namespace lte::datagen::test
