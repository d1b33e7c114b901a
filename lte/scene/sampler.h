// Area-weighted sampling of surface points: the paper's scene points and query points
// (section 3.2).
#pragma once

#include <cstdint>
#include <vector>

#include "lte/scene/scene.h"

namespace lte::scene {

/// Structure of arrays, one entry a point, world space.
struct SurfaceSamples {
  std::vector<Vec3> position, normal;
  std::vector<Rgb> albedo, emission;
  std::vector<Gloss> gloss;
  std::vector<float> area;       ///< m² that the point stands for
  std::vector<int> light_group;  ///< kNone unless emissive

  int64_t size() const { return static_cast<int64_t>(position.size()); }
};

struct SamplerOptions {
  uint64_t seed = 0;
  /// Share of points that is guaranteed to emissive surfaces, so that a small luminaire is never
  /// missed; their `area` stays true. 0 for plain area weighting, as for query points.
  double emissive_share = 0.0;
  /// Points over which textures are averaged stand for area/count; false samples the finest level
  /// (query points).
  bool filter_footprint = true;
  /// Share of points that stand for the environment of a scene that has one, on the sphere around
  /// it (environment_points.h), so that the network sees it; at least 1 unless 0. `emissive_share` is of the
  /// rest.
  double environment_share = 0.05;
  /// Adds one small emissive sample for each point and spot light (DESIGN section 5): emission such
  /// that emission * area * pi equals the light's power over 4 pi.
  bool punctual_lights = true;
};

/// Exactly `count` points, stratified over the total area in instance order (one uniform variate a
/// stratum), so equal areas get equal numbers to within one; punctual lights and the environment's
/// points come last. The same for any number of threads.
/// @throws lte::Error if the scene has no area or `count` < 1.
SurfaceSamples sample_surface(const Scene& scene, int64_t count, const SamplerOptions& options);

/// How many of `count` points stand for the environment.
int64_t environment_point_count(const Scene& scene, int64_t count, const SamplerOptions& options);

/// Total world area of a scene, m².
double surface_area(const Scene& scene);

}  // namespace lte::scene
