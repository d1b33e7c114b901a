// The released model on two of the shipped homes: its errors stay where they were measured.
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <span>

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
constexpr Recorded kRecorded[] = {{"home_00002", 0.7836860010873258, 0.13322936236901642},
                                  {"home_00004", 0.3624815582219766, 0.09190767203789856}};
constexpr double kTolerance = 0.05;

/// A data set in `folder` that has just these homes, of the shipped ones.
void write_homes(const std::filesystem::path& folder, std::span<const Recorded> homes) {
  const std::filesystem::path shipped = LTE_SOURCE_DIR "/assets/data/homes-test";
  data::DatasetInfo info = data::read_dataset_info(shipped);
  info.planned = static_cast<int64_t>(homes.size());
  std::erase_if(info.scenes, [&](const data::DatasetEntry& entry) {
    return std::none_of(homes.begin(), homes.end(),
                        [&](const Recorded& recorded) { return entry.name == recorded.home; });
  });
  std::filesystem::create_directories(folder / "scenes");
  for (const Recorded& recorded : homes)
    std::filesystem::copy_file(data::scene_path(shipped, recorded.home),
                               data::scene_path(folder, recorded.home));
  data::write_dataset_info(folder, info);
}

TEST(ReleasedModel, HasTheErrorThatWasMeasured) {
  const test::TempDir folder;
  write_homes(folder / "homes", kRecorded);
  const std::string command =
      concat("'", LTE_BINARY_DIR, "/bin/lte_eval' --quiet --split test --threads 2 --data '",
             (folder / "homes").string(), "' --checkpoint '", LTE_SOURCE_DIR,
             "/assets/models/lte.safetensors' --json '", (folder / "eval.json").string(), "'");
  ASSERT_EQ(std::system((command + " > /dev/null").c_str()), 0) << command;
  const auto scenes = nlohmann::json::parse(read_file(folder / "eval.json")).at("per_scene");
  ASSERT_EQ(scenes.size(), std::size(kRecorded));
  for (size_t i = 0; i < scenes.size(); ++i) {
    const Recorded& recorded = kRecorded[i];
    const auto& neural = scenes[i].at("metrics").at("neural");
    const auto expect = [&](const char* where, double mse) {
      EXPECT_NEAR(neural.at(where).at("mse").get<double>(), mse, kTolerance * mse)
          << recorded.home << ", " << where;
    };
    EXPECT_EQ(scenes[i].at("name"), recorded.home);
    expect("points", recorded.points_mse);
    expect("views", recorded.views_mse);
  }
}

}  // namespace
}  // namespace lte::infer
