// The cheapest predictor of indirect irradiance to compare the network with: constant_mean, the
// mean over training scenes, everywhere. Values are irradiance over the scene's emission scalar.
// The mean is fitted on the training split, never on the scenes that are evaluated, and travels
// with the model as a small JSON file.
#pragma once

#include <cstdint>
#include <filesystem>

#include "lte/data/scene_sample.h"

namespace lte::infer {

struct Baselines {
  /// constant_mean: the mean of indirect irradiance over points and channels. All scenes weigh
  /// alike.
  double mean = 1;
  int64_t scenes = 0;  ///< number of training scenes behind it
};

/// Atomic.
void write_baselines(const std::filesystem::path& path, const Baselines& baselines);
/// @throws lte::Error naming the file and the key.
Baselines read_baselines(const std::filesystem::path& path);

/// <folder>/<stem>.baselines.json of <folder>/<stem>.safetensors.
std::filesystem::path baselines_path(const std::filesystem::path& checkpoint);

/// Fits the baselines to training scenes that are added one by one.
class BaselineFit {
 public:
  void add(const data::SceneSample& sample);
  /// @throws lte::Error if no scene was added.
  Baselines finish() const;

 private:
  int64_t scenes_ = 0;
  double mean_sum_ = 0;
};

/// The emission scalar of a baked scene.
double mean_emission(const data::SceneSample& sample);

}  // namespace lte::infer
