// Data sets that are not what they should be: refused with the file's name, or gone on without.
#include <cstring>
#include <fstream>
#include <limits>
#include <map>

#include "lte/base/file.h"
#include "lte/base/safetensors.h"
#include "lte/data/held_out.h"
#include "tests/train/run_fixture.h"
#include "train/data/batch.h"

namespace lte::train {
namespace {

namespace fs = std::filesystem;

/// Writes the file again with one value of a tensor and one metadatum changed.
void rewrite(const fs::path& path, const std::string& tensor, float value,
             const std::map<std::string, std::string>& metadata = {}) {
  std::map<std::string, std::vector<std::byte>> bytes;
  SafetensorsWriter writer;
  {
    const SafetensorsFile file(path);
    for (const auto& [name, view] : file.tensors()) {
      std::vector<std::byte>& copy = bytes[name];
      copy.assign(view.data, view.data + view.size_bytes());
      if (name == tensor) std::memcpy(copy.data() + 40, &value, sizeof(value));
      writer.add(name, TensorView{view.dtype, view.shape, copy.data()});
    }
    for (const auto& [key, text] : file.metadata()) writer.set_metadata(key, text);
  }
  for (const auto& [key, text] : metadata) writer.set_metadata(key, text);
  writer.write(path);
}

struct Fault {
  const char* name;
  void (*damage)(const fs::path& scene);
  const char* message;  ///< beside the file's name
};
constexpr float kNan = std::numeric_limits<float>::quiet_NaN(),
                kInfinity = std::numeric_limits<float>::infinity();
const std::vector<Fault> kFaults = {
    {"missing", [](const fs::path& file) { fs::remove(file); }, ""},
    {"empty", [](const fs::path& file) { fs::resize_file(file, 0); }, "0 bytes"},
    {"truncated", [](const fs::path& file) { fs::resize_file(file, fs::file_size(file) / 2); },
     "truncated"},
    {"no numbers", [](const fs::path& file) { rewrite(file, "indirect", kNan); }, "indirect"},
    {"negative", [](const fs::path& file) { rewrite(file, "indirect", -1); }, "is negative"},
    {"infinite", [](const fs::path& file) { rewrite(file, "indirect", kInfinity); }, "not finite"},
    {"infinite emission", [](const fs::path& file) { rewrite(file, "scene_emission", kInfinity); },
     "scene_emission"},
    {"negative area", [](const fs::path& file) { rewrite(file, "scene_area", -1); }, "scene_area"},
    {"a position that is no number",
     [](const fs::path& file) { rewrite(file, "query_position", kNan); }, "query_position"},
    {"larger than the scale", [](const fs::path& file) { rewrite(file, "scene_position", 30); },
     "scale of 8 m"},
    {"another version",
     [](const fs::path& file) {
       rewrite(file, "", 0, {{"version", "7"}});
     },
     "version 7"},
};

/// Six rooms to train on and two to validate on; room2 and room6 are bad.
class BadData : public test::RunFixture {
 protected:
  void write(const Fault& fault) {
    fs::remove_all(root());
    test::write_dataset(root(), 6, 2);
    for (const char* name : {"room2", "room6"}) fault.damage(data::scene_path(root(), name));
  }
  fs::path root() const { return dir_ / "data"; }
  TrainConfig config(const std::string& run, const std::string& extra = "") const {
    return test::tiny_config(root(), dir_ / run, extra);
  }
  static constexpr const char* kSkip = "data: {on_bad_scene: skip}\n";
};

TEST_F(BadData, IsRefusedWithTheFileAndTheWayOn) {
  for (const Fault& fault : kFaults) {
    SCOPED_TRACE(fault.name);
    write(fault);
    const bool missing = std::string(fault.name) == "missing";
    test::expect_error(
        [&] { train(config("run")); },
        {"room2.safetensors", fault.message, missing ? "is missing" : "data.on_bad_scene=skip"});
    EXPECT_FALSE(fs::exists(checkpoint_path(dir_ / "run")));
  }
}

TEST_F(BadData, ASceneOfTheOutsideTestSetIsRefused) {
  test::write_dataset(root(), 6, 2);
  const data::HeldOutScene& outside = data::held_out_scenes().front();
  for (const char* room : {"room2", "room6"}) {  // to train on, and to validate on
    const fs::path file = data::scene_path(root(), room);
    const auto check = [&](const char* key, const std::string& value) {
      const std::string before = read_file(file);
      rewrite(file, "", 0, {{key, value}});
      for (const char* extra : {"", kSkip})
        test::expect_error([&] { open_run_data(config("run", extra)); },
                           {root().string(), room, outside.name, "assets/scenes/outside"});
      write_file(file, before);
    };
    check("name", outside.name);
    check("geometry", outside.geometry);
  }
  EXPECT_NO_THROW(open_run_data(config("run")));
}

TEST_F(BadData, IsSkippedAndCounted) {
  for (const Fault& fault : kFaults) {
    SCOPED_TRACE(fault.name);
    write(fault);
    fs::remove_all(dir_ / "run");
    TrainSummary summary;
    const std::string said = test::captured_stderr([&] { summary = train(config("run", kSkip)); });
    EXPECT_EQ(summary.step, 8);
    EXPECT_EQ(summary.bad_scenes, 2);
    for (const char* scene : {"scene room2 is skipped: ", "scene room6 is skipped: "}) {
      const size_t first = said.find(scene);
      EXPECT_NE(first, std::string::npos) << said;
      EXPECT_EQ(said.find(scene, first + 1), std::string::npos) << "twice: " << said;
    }
    EXPECT_NE(said.find(fault.message), std::string::npos) << said;
    EXPECT_NE(said.find("1 of 6 training scenes and 1 validation scenes could not be used"),
              std::string::npos)
        << said;
  }
}

TEST_F(BadData, SkippingIsTheSameEveryTimeAndAcrossSessions) {
  write(kFaults[2]);
  train(config("straight", kSkip));
  train(config("pieces", kSkip), false, 3);
  train(config("pieces", kSkip), true);
  for (const char* file : {"checkpoint.safetensors", "model_best.safetensors"})
    test::expect_same_tensors(dir_ / "straight" / file, dir_ / "pieces" / file);
  EXPECT_EQ(test::log_values(dir_ / "straight"), test::log_values(dir_ / "pieces"));
}

TEST_F(BadData, AllProcessesTogetherSkipAsOneDoes) {
  write(kFaults[2]);
  const TrainConfig run = config("run", std::string(kSkip) + "train: {scenes_per_step: 3}\n");
  RunData alone = open_run_data(run), even = open_run_data(run), odd = open_run_data(run);
  BatchLoader one(run, alone.scale, &alone.train);
  Rank first, second;
  first.count = second.count = 2;
  second.index = 1;
  BatchLoader a(run, even.scale, &even.train, first), b(run, odd.scale, &odd.train, second);
  std::map<std::string, int> seen;
  for (int64_t step = 0; step < 8; ++step) {
    const auto all = one.take(step), of_a = a.take(step), of_b = b.take(step);
    ASSERT_EQ(all.size(), 3u);
    ASSERT_EQ(of_a.size(), 2u);
    ASSERT_EQ(of_b.size(), 1u);
    const Example* theirs[3] = {&of_a[0], &of_b[0], &of_a[1]};
    for (size_t slot = 0; slot < 3; ++slot) {
      EXPECT_EQ(all[slot].scene, theirs[slot]->scene);
      EXPECT_TRUE(at::equal(all[slot].target, theirs[slot]->target));
      ++seen[all[slot].scene];
    }
  }
  EXPECT_EQ(seen.size(), 5u) << "every good scene";
  EXPECT_FALSE(seen.contains("room2"));
  for (const auto& [scene, times] : seen) EXPECT_GE(times, 4) << scene << ": once an epoch";
}

TEST_F(BadData, WithoutAGoodSceneTheRunEnds) {
  test::write_dataset(root(), 2, 0);
  for (const char* name : {"room0", "room1"}) fs::resize_file(data::scene_path(root(), name), 100);
  test::expect_error([&] { train(config("run", kSkip)); }, {"none of its 2 scenes"});
}

TEST_F(BadData, ADataSetOfAnotherVersionIsRefused) {
  test::write_dataset(root(), 2, 0);
  const fs::path path = root() / "dataset.json";
  std::string text = read_file(path);
  const std::string version = "\"version\": 1";
  ASSERT_NE(text.find(version), std::string::npos);
  text.replace(text.find(version), version.size(), "\"version\": 2");
  std::ofstream(path) << text;
  for (const char* extra : {"", kSkip})
    test::expect_error([&] { train(config("run", extra)); }, {"dataset.json", "version", "2"});
}

TEST_F(BadData, ADataSetOfAnotherScaleIsRefusedOnResume) {
  test::write_dataset(root(), 4, 1);
  train(config("run"), false, 2);
  data::DatasetInfo info = data::read_dataset_info(root());
  info.scale = 12;
  data::write_dataset_info(root(), info);
  test::expect_error([&] { train(config("run"), true); },
                     {"checkpoint.safetensors", "scale", "8 m", "12 m"});
}

TEST_F(BadData, CheckingCountsWhatWouldBeSkipped) {
  write(kFaults[3]);
  const std::string text = check_run_data(config("run", kSkip));
  EXPECT_NE(text.find("5 scenes to train on, 1 to validate on"), std::string::npos) << text;
  EXPECT_NE(text.find("valid but for 2 scenes"), std::string::npos) << text;
  test::expect_error([&] { check_run_data(config("run")); }, {"room2.safetensors", "indirect"});
}

}  // namespace
}  // namespace lte::train
