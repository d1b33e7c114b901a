// Irradiance at points by the network, and what error to expect of it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lte/base/math.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/probe.h"
#include "lte/runtime/embedding.h"
#include "lte/scene/point_table.h"

namespace lte::infer {

/// The albedo at each point, which the network reads: that of the surface that it lies on.
struct PointAlbedo {
  std::vector<Rgb> albedo;  ///< kFreeAlbedo for points on no surface
  int64_t off_surface = 0;  ///< how many those are
};

/// Looks along each normal for a surface within kSurfaceDistance of the scene's extent.
PointAlbedo albedo_at(const pathtrace::Bvh& bvh, const scene::PointTable& points);

inline constexpr float kSurfaceDistance = 1e-3f;
inline constexpr Rgb kFreeAlbedo{0.5f, 0.5f, 0.5f};

/// Several answers to the same questions, each by an embedding of points and light estimates of its
/// own.
class Draws {
 public:
  void add(const std::vector<Rgb>& answers);

  size_t count() const { return answers_.size(); }
  /// The mean over the draws.
  std::vector<Rgb> mean() const;
  /// What of the mean's error the draws tell: the standard error of the mean at each point, root
  /// mean square over the channels. Empty of a single draw.
  std::vector<double> standard_error() const;

 private:
  std::vector<std::vector<Rgb>> answers_;
};

/// The error to expect of the network's irradiance at each point, W/m², root mean square over the
/// channels: docs/metrics.md has how it was fitted and how often it holds.
/// @param answer  the network's, indirect or total, by the target
std::vector<double> expected_error(std::span<const Rgb> answer,
                                   std::span<const double> standard_error);

/// Root of the mean square over the channels.
double rms(const Rgb& value);

}  // namespace lte::infer
