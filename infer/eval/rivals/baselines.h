// Cheap predictors of indirect irradiance to compare the network with. docs/metrics.md defines
// them.
//
// All values are irradiance over the scene's emission scalar. What a predictor has to know of other
// scenes is fitted on the training split, never on the scenes that are evaluated, and travels with
// the model as a small JSON file.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "infer/light/points.h"
#include "lte/data/light_groups.h"
#include "lte/data/scene_sample.h"

namespace lte::infer {

inline constexpr int kHeightBins = 8;  ///< of height over the scene's
inline constexpr int kFacingBins = 3;  ///< down, sideways, up
inline constexpr int kAlbedoBins = 4;  ///< of albedo luminance in [0, 1]

struct Baselines {
  /// constant_mean: the mean of indirect irradiance over points and channels. All scenes weigh
  /// alike.
  double mean = 1;
  /// nearest_point: mean indirect irradiance by bin, [height][facing][albedo]; bins that no point
  /// met hold the mean.
  std::vector<Rgb> table;
  double blur_bandwidth = 0.125;  ///< blurred_direct: σ over the scene's largest extent
  double blur_gain = 1;           ///< blurred_direct: factor on the blurred reflected light
  int64_t scenes = 0;             ///< number of training scenes behind the figures
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

  static constexpr std::array<double, 5> kBandwidths = {1.0 / 2, 1.0 / 4, 1.0 / 8, 1.0 / 16,
                                                        1.0 / 32};

 private:
  int64_t scenes_ = 0;
  double mean_sum_ = 0;
  // By bin: sums of irradiance, x y z, and the number of points.
  std::vector<std::array<double, 4>> bins_ =
      std::vector<std::array<double, 4>>(kHeightBins * kFacingBins * kAlbedoBins);
  // By bandwidth: sums over scenes of the means of B·t and of B², with B the blurred light and t
  // the target.
  std::array<double, kBandwidths.size()> cross_{}, square_{};
};

/// The predictors on one scene. Keeps a reference to the sample.
class BaselinePredictor {
 public:
  /// @param radiance  the scene's emission scalar
  BaselinePredictor(const Baselines& baselines, const data::SceneSample& sample, double radiance);

  std::vector<Rgb> constant_mean(const QueryPoints& queries) const;
  std::vector<Rgb> nearest_point(const QueryPoints& queries) const;
  std::vector<Rgb> blurred_direct(const QueryPoints& queries) const;

 private:
  const Baselines& baselines_;
  const data::SceneSample& sample_;
  double radiance_;
};

/// The emission scalar of a baked scene.
double mean_emission(const data::SceneSample& sample);

}  // namespace lte::infer
