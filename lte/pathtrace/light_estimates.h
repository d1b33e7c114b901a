// A few paths at each of the points that describe a scene: noisy estimates of the light there, which
// a network only has to interpolate and denoise.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lte/base/math.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/lights.h"

namespace lte::pathtrace {

/// A network learns the noise and the depth of the estimates that it was trained with: rendering must
/// make them as baking did. Data sets and models therefore carry `paths` and `max_depth` as
/// `light_paths` and `light_depth`, and no field has a default here.
struct LightEstimateOptions {
  int paths;      ///< paths a side of a point
  int max_depth;  ///< surface hits of a path, as in IrradianceOptions; 1 is direct light alone
  uint64_t seed;  ///< results depend on it and on the order of the points, not on threads
};

/// E(n) + E(−n) by light group at unit gain, W/m², [groups, points] each: light of depth 1, and of
/// depths 2 to max_depth. Unbiased.
struct LightEstimates {
  std::vector<Rgb> direct, indirect;
};

/// Surfaces reflect on both sides, and which of them the normal names is up to the file; the outside
/// of a closed wall is dark. Points that emit get 0: what a luminaire reflects is little beside its
/// emission, and a point light has no surface.
/// @param normals   unit
/// @param emission  one a position: points with emission above 0 are luminaires
/// @throws lte::Error as estimate_irradiance(), or if the arrays differ in length.
LightEstimates estimate_light(const Bvh& bvh, const Lights& lights, std::span<const Vec3> positions,
                              std::span<const Vec3> normals, std::span<const Rgb> emission,
                              const LightEstimateOptions& options);

}  // namespace lte::pathtrace
