#include "infer/eval/baselines/baselines.h"

#include <vector>

#include <nlohmann/json.hpp>

#include "lte/base/check.h"
#include "lte/base/file.h"
#include "lte/data/light_groups.h"
#include "lte/runtime/points.h"

namespace lte::infer {
namespace {

constexpr const char* kFormat = "lte-baselines";
constexpr int kVersion = 1;

double mean_of(std::span<const Rgb> values) {
  double sum = 0;
  for (const float value : runtime::floats(values)) sum += value;
  return values.empty() ? 0 : sum / (3.0 * static_cast<double>(values.size()));
}

}  // namespace

double mean_emission(const data::SceneSample& s) {
  return runtime::mean_emission(
      {s.scene_position, s.scene_normal, s.scene_albedo, s.scene_emission, s.scene_area});
}

std::filesystem::path baselines_path(const std::filesystem::path& checkpoint) {
  std::filesystem::path path = checkpoint;
  return path.replace_extension(".baselines.json");
}

void write_baselines(const std::filesystem::path& path, const Baselines& baselines) {
  const nlohmann::json json = {{"format", kFormat},
                               {"version", kVersion},
                               {"scenes", baselines.scenes},
                               {"constant_mean", {{"mean", baselines.mean}}}};
  write_file(path, json.dump(1) + '\n');
}

Baselines read_baselines(const std::filesystem::path& path) {
  try {
    const nlohmann::json json = nlohmann::json::parse(read_file(path));
    LTE_CHECK(json.at("format") == kFormat, path.string(), ": not a baselines file");
    LTE_CHECK(json.at("version") == kVersion, path.string(), ": version ",
              json.at("version").dump(), ", expected ", kVersion);
    return {json.at("constant_mean").at("mean"), json.at("scenes")};
  } catch (const nlohmann::json::exception& error) {
    throw Error(concat(path.string(), ": ", error.what()));
  }
}

void BaselineFit::add(const data::SceneSample& sample) {
  const std::vector<Rgb> target =
      data::sum_groups(sample.indirect, sample.light_groups, 1 / mean_emission(sample));
  if (target.empty()) return;
  ++scenes_;
  mean_sum_ += mean_of(target);
}

Baselines BaselineFit::finish() const {
  LTE_CHECK(scenes_ > 0, "baselines need at least one training scene with a light");
  return {mean_sum_ / static_cast<double>(scenes_), scenes_};
}

}  // namespace lte::infer
