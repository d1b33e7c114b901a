// A few paths at each of the points that describe a scene: noisy estimates of the light there,
// which a network only has to interpolate and denoise.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "lte/base/math.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/lights/lights.h"

namespace lte::pathtrace {

/// A network learns the noise and the depth of the estimates that it was trained with: rendering
/// must make them as baking did. Data sets and models therefore carry `paths` and `max_depth` as
/// `light_paths` and `light_depth`, and no field has a default here.
struct LightEstimateOptions {
  int paths;      ///< paths a side of a point
  int max_depth;  ///< surface hits of a path, as in IrradianceOptions; 1 is direct light alone
  uint64_t seed;  ///< results depend on it and on the order of the points, not on threads
  /// Called now and then; what it throws ends the estimates. May be null.
  std::function<void()> check = {};
};

/// By light group at unit gain, [groups, points] each. Irradiance is in W/m² and unbiased.
struct LightEstimates {
  std::vector<Rgb> direct, indirect;  ///< E(n) + E(−n): light of depth 1; of depths 2 to max_depth
  std::vector<Rgb> direct_back, indirect_back;  ///< of these, E(−n)
  /// Standard error of E(n) and of E(−n) of depths 2 to max_depth over their value, of the mean
  /// over the color channels: in [0, 1], 0 where there is no light. From fewer than 4 paths it
  /// means nothing, and from 32 it is itself known to half.
  std::vector<float> error, error_back;
};

/// Surfaces reflect on both sides, and which of them the normal names is up to the file; the
/// outside of a closed wall is dark. Points that emit get 0: what a luminaire reflects is little
/// beside its emission, and a point light has no surface.
/// @param normals   unit
/// @param emission  one a position: points with emission above 0 are luminaires
/// @throws lte::Error as estimate_irradiance(), or if the arrays differ in length.
LightEstimates estimate_light(const Bvh& bvh, const Lights& lights, std::span<const Vec3> positions,
                              std::span<const Vec3> normals, std::span<const Rgb> emission,
                              const LightEstimateOptions& options);

}  // namespace lte::pathtrace
