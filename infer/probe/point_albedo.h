// The albedo at points, which the network reads: that of the surface that a point lies on.
#pragma once

#include <cstdint>
#include <vector>

#include "lte/base/math.h"
#include "lte/pathtrace/bvh.h"
#include "lte/scene/point_table.h"

namespace lte::infer {

struct PointAlbedo {
  std::vector<Rgb> albedo;  ///< kFreeAlbedo for points on no surface
  int64_t off_surface = 0;  ///< how many those are
};

/// Looks along each normal for a surface within kSurfaceDistance of the scene's extent.
PointAlbedo albedo_at(const pathtrace::Bvh& bvh, const scene::PointTable& points);

inline constexpr float kSurfaceDistance = 1e-3f;
inline constexpr Rgb kFreeAlbedo{0.5f, 0.5f, 0.5f};

}  // namespace lte::infer
