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
#include <memory>
#include <span>
#include <vector>

#include "lte/base/math.h"
#include "lte/base/random.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/lights/lights.h"
#include "lte/scene/scene.h"
#include "lte/scene/surface.h"

namespace lte::pathtrace {

class Guide;

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

/// Directions from a point and one path's radiance along each.
struct IncidentSamples {
  int64_t groups = 0, count = 0;
  std::vector<Vec3> direction;  ///< [count] world, unit, away from the point
  /// [count] solid-angle density that the direction was drawn with; 0 for a draw that no direction
  /// came of, which counts as a sample of 0.
  std::vector<float> pdf;
  std::vector<Rgb> direct, indirect;  ///< [groups, count] radiance at unit gain, as above
};

/// A glossy surface and where it is seen from, for directions that it reflects.
struct Reflector {
  Rgb color;           ///< [0, 1]
  scene::Gloss gloss;  ///< metallic above 0
  Vec3 outgoing;       ///< world, unit, away from the surface
};

/// Draws incident radiance as it is needed, for those who store none of it: a trainer, or a
/// renderer that compares. Not thread-safe: one a thread. Keeps references to what it is given.
class IncidentSampler {
 public:
  /// @throws lte::Error if the BVH and the lights are of two scenes, or a depth is below 1.
  IncidentSampler(const Bvh& bvh, const Lights& lights, int max_depth = 5, int roulette_depth = 3);
  ~IncidentSampler();

  /// Cosine-distributed directions.
  /// @param normal  unit
  /// @param rng     what is drawn depends on its state, and moves it on
  /// @return  valid until the next call
  const IncidentSamples& draw(const Vec3& position, const Vec3& normal, int64_t count, Rng& rng);

  /// Directions as likely as the surface reflects light from them (GGX visible normals and cosine,
  /// by its share of metal).
  /// @throws lte::Error if `reflector` is not metallic or is seen from behind `normal`.
  const IncidentSamples& draw(const Vec3& position, const Vec3& normal, const Reflector& reflector,
                              int64_t count, Rng& rng);

  /// Directions of a guide at this point (guide.h).
  const IncidentSamples& draw(const Vec3& position, const Vec3& normal, const Guide& guide,
                              int64_t count, Rng& rng);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace lte::pathtrace
