// A few paths at each of the points that describe a scene: noisy estimates of the light there, from
// which a network need but interpolate and denoise.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lte/base/math.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/lights.h"

namespace lte::pathtrace {

/// Paths a side of a scene point. A network was trained with this noise: baking and rendering must
/// agree.
inline constexpr int kLightEstimateRays = 32;

/// E(n) + E(−n) by light group at unit gain, W/m², [groups, points] each: light of depth 1, and of
/// depths 2 to max_depth. Unbiased.
struct LightEstimates {
  std::vector<Rgb> direct, indirect;
};

/// Surfaces reflect on both sides, and which of them the normal names is up to the file; of closed
/// walls one is dark. Points that emit get 0: what a luminaire reflects is little beside its
/// emission, and a point light has no surface.
/// @param normals    unit, @param emission as long: which points are luminaires
/// @param max_depth  surface hits of a path (IrradianceOptions)
/// @param seed       results depend on it and on the order of points, not on threads
/// @throws lte::Error as estimate_irradiance()
LightEstimates estimate_light(const Bvh& bvh, const Lights& lights, std::span<const Vec3> positions,
                              std::span<const Vec3> normals, std::span<const Rgb> emission,
                              int max_depth, uint64_t seed, int rays = kLightEstimateRays);

}  // namespace lte::pathtrace
