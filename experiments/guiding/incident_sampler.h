// Incident radiance (incident.h) drawn as it is needed, a path a direction.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "lte/base/math.h"
#include "lte/base/random.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/lights/lights.h"
#include "lte/scene/surface.h"

namespace lte::experiments {

class Guide;
class GuideField;

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
  /// @param field  guides paths on where they meet diffuse surfaces; null: they go on by the
  ///               cosine. The mean of what is drawn is the same.
  /// @throws lte::Error if the BVH and the lights are of two scenes, or a depth is below 1.
  IncidentSampler(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                  const GuideField* field = nullptr, int max_depth = 5, int roulette_depth = 3);
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

  class State;  ///< defined where the paths are traced

 private:
  std::unique_ptr<State> state_;
};

}  // namespace lte::experiments
