// What the pixels of a picture see, as sparse answers look at it.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include "lte/base/math.h"

namespace lte::gi {

/// Views of arrays [height * width] of a picture, or of some rows of it.
struct PixelSurfaces {
  int width = 0, height = 0;
  std::span<const Vec3> position, normal;  ///< world; normals are unit
  std::span<const float> depth;            ///< along the camera's axis
  std::span<const uint8_t> mask;           ///< 1 where irradiance is wanted
  float pixel_size = 0;                    ///< edge of what a pixel covers at depth 1, in metres

  size_t size() const { return static_cast<size_t>(width) * static_cast<size_t>(height); }
  size_t at(int x, int y) const {
    return static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x);
  }
};

/// A point whose irradiance is taken from that of pixels.
struct SurfacePoint {
  Vec3 position, normal;
  float depth = 0;
};

inline SurfacePoint point_of(const PixelSurfaces& surfaces, size_t pixel) {
  return {surfaces.position[pixel], surfaces.normal[pixel], surfaces.depth[pixel]};
}

/// Normals that differ by more than 26° share no irradiance.
inline constexpr float kLeastCosine = 0.9f;
/// Nor do points that lie farther than this from each other's plane, in edges of a pixel there.
inline constexpr float kMostPlaneDistance = 1;

/// How well the irradiance at pixel `source` stands for that at `point`: 1 if each lies in the
/// plane of the other under the same normal, 0 beyond the limits above, linear between. Rounding of
/// positions does not show: up to a fifth of the limits it stays 1.
inline float similarity(const PixelSurfaces& surfaces, const SurfacePoint& point, size_t source) {
  const Vec3& normal = surfaces.normal[source];
  const float cosine = dot(point.normal, normal);
  if (cosine <= kLeastCosine) return 0;
  const Vec3 between = surfaces.position[source] - point.position;
  const float distance =
      std::max(std::abs(dot(between, point.normal)), std::abs(dot(between, normal)));
  const float limit =
      kMostPlaneDistance * std::min(point.depth, surfaces.depth[source]) * surfaces.pixel_size;
  if (!(distance < limit)) return 0;
  // Where both factors are 1, no quotient is needed.
  if (distance * 5.01f < limit && cosine > kLeastCosine + 0.801f * (1 - kLeastCosine)) return 1;
  const float in_plane = 1 - distance / limit;
  const float alike = (cosine - kLeastCosine) / (1 - kLeastCosine);
  return std::min(1.0f, 1.25f * in_plane) * std::min(1.0f, 1.25f * alike);
}

}  // namespace lte::gi
