// Incident radiance: what glossy surfaces reflect, and the target of the paper's radiance decoder
// (section 5.3 and supplementary section 4).
//
// At a point, L(ω) is the radiance that arrives from direction ω. It follows the depth convention
// of irradiance: depth 1 is the emission of what the direction meets, environment included; depth d
// has d surface hits. A punctual light has no radiance in any direction and counts from depth 2 on,
// through the surfaces that it lights; so ∫ L cosθ dω is irradiance.h's E, but for the direct share
// of punctual lights.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lte/base/math.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/lights/lights.h"

namespace lte::pathtrace {

struct IncidentOptions {
  int bins = 32;     ///< even: bins × bins cells a point (hemisphere_bins.h)
  int samples = 64;  ///< paths a cell
  int max_depth = 5;
  uint64_t seed = 0;
  int roulette_depth = 3;  ///< as in IrradianceOptions
};

/// Mean radiance over each cell, by light group at unit gain, linear Rec.709, W sr^-1 m^-2. The
/// mean is that of cosine-distributed directions, so E = π / bins² Σ L over the cells.
struct IncidentRadiance {
  int64_t groups = 0, points = 0;
  int bins = 0;
  std::vector<Rgb> direct;    ///< [groups, points, bins, bins]: depth 1
  std::vector<Rgb> indirect;  ///< [groups, points, bins, bins]: depths 2 to max_depth
  int64_t rays_traced = 0;

  int64_t cells() const { return int64_t{bins} * bins; }
};

/// Each cell's directions are a randomized point set of their own. Point i draws from stream (seed,
/// first_index + i), so the result depends neither on threads nor on how a set is cut into calls.
/// @param normals  unit
/// @throws lte::Error if sizes differ, a value is not finite, or options are out of range.
IncidentRadiance estimate_incident(const Bvh& bvh, const Lights& lights,
                                   std::span<const Vec3> positions, std::span<const Vec3> normals,
                                   const IncidentOptions& options, int64_t first_index = 0);

}  // namespace lte::pathtrace
