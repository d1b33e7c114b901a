// The released model on two of the shipped homes: its errors stay where they were measured.
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <iterator>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "lte/base/check.h"
#include "lte/base/file.h"
#include "tests/infer/fixture.h"

namespace lte::infer {
namespace {

/// MSE of indirect irradiance over the mean emission: metrics.neural.{points,views}.mse of a scene
/// in what `lte_eval --split test --json eval.json` writes. Processors differ in the sixth digit.
struct Recorded {
  const char* home;
  double points_mse, views_mse;
};
constexpr Recorded kRecorded[] = {{"home_00002", 1.2683529342583213, 0.1777509457209548},
                                  {"home_00004", 0.6728384700379173, 0.1768641915005412}};
constexpr double kTolerance = 0.05;

/// A data set in `folder` that has just the homes above, of the shipped ones.
void write_recorded_homes(const std::filesystem::path& folder) {
  const std::filesystem::path shipped = LTE_SOURCE_DIR "/assets/data/homes-test";
  data::DatasetInfo info = data::read_dataset_info(shipped);
  info.planned = std::size(kRecorded);
  std::erase_if(info.scenes, [](const data::DatasetEntry& entry) {
    return std::none_of(std::begin(kRecorded), std::end(kRecorded),
                        [&](const Recorded& recorded) { return entry.name == recorded.home; });
  });
  std::filesystem::create_directories(folder / "scenes");
  for (const Recorded& recorded : kRecorded)
    std::filesystem::copy_file(data::scene_path(shipped, recorded.home),
                               data::scene_path(folder, recorded.home));
  data::write_dataset_info(folder, info);
}

TEST(ReleasedModel, HasTheErrorThatWasMeasured) {
  const test::TempDir folder;
  write_recorded_homes(folder / "homes");
  const std::string command = concat(
      "'", LTE_BINARY_DIR, "/bin/lte_eval' --quiet --split test --threads 2 --data '",
      (folder / "homes").string(), "' --checkpoint '", LTE_SOURCE_DIR,
      "/assets/models/lte-small.safetensors' --json '", (folder / "eval.json").string(), "'");
  ASSERT_EQ(std::system((command + " > /dev/null").c_str()), 0) << command;
  const auto scenes = nlohmann::json::parse(read_file(folder / "eval.json")).at("per_scene");
  ASSERT_EQ(scenes.size(), std::size(kRecorded));
  for (size_t i = 0; i < scenes.size(); ++i) {
    const auto& neural = scenes[i].at("metrics").at("neural");
    const auto expect = [&](const char* where, double recorded) {
      EXPECT_NEAR(neural.at(where).at("mse").get<double>(), recorded, kTolerance * recorded)
          << kRecorded[i].home << ", " << where;
    };
    EXPECT_EQ(scenes[i].at("name"), kRecorded[i].home);
    expect("points", kRecorded[i].points_mse);
    expect("views", kRecorded[i].views_mse);
  }
}

}  // namespace
}  // namespace lte::infer
