// Error of indirect irradiance with and without an improvement of the path tracer's sampling.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lte/base/math.h"
#include "lte/pathtrace/bvh.h"

namespace lte::experiments {

/// Error of indirect irradiance before and after an improvement, at the same number of paths.
struct ErrorGain {
  int64_t rays = 0;  ///< paths a point
  /// Root mean square over points and channels, relative to the mean.
  double rmse_before = 0, rmse_after = 0;
  /// Ratio of the squares: how many times as many paths the error after takes without it.
  double rays_ratio = 0;
};

/// How errors are measured: with each number of paths, `repeats` times with other seeds, against a
/// reference of `reference_rays`, whose own variance is subtracted.
struct GainOptions {
  std::vector<int> rays{64, 256, 1024};
  int reference_rays = 1 << 14, repeats = 12, max_depth = 5;
};

/// Independent random numbers against stratified ones.
std::vector<ErrorGain> measure_stratification(const pathtrace::Bvh& bvh,
                                              std::span<const Vec3> positions,
                                              std::span<const Vec3> normals,
                                              const GainOptions& options);

/// Lights drawn by power against the light tree.
std::vector<ErrorGain> measure_light_tree(const pathtrace::Bvh& bvh,
                                          std::span<const Vec3> positions,
                                          std::span<const Vec3> normals,
                                          const GainOptions& options);

}  // namespace lte::experiments
