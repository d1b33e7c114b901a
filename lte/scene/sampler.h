// Area-weighted sampling of surface points: the scene points and query points of the paper's
// section 3.2.
#pragma once

#include <cstdint>
#include <vector>

#include "lte/scene/scene.h"
#include "lte/scene/surface.h"

namespace lte::scene {

/// A structure of arrays, one entry a point, in world space.
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
  /// True averages textures over the area that a point stands for (scene points); false samples the
  /// finest level (query points).
  bool filter_footprint = true;
  /// Share of points that stand for the environment of a scene that has one, on the sphere around
  /// it (environment_points.h), so that the network sees it. Unless 0, there is at least one such
  /// point. `emissive_share` is a share of the rest.
  double environment_share = 0.05;
  /// Adds one small emissive sample for each point and spot light, with an emission such that
  /// emission * area * pi equals the light's power over 4 pi.
  bool punctual_lights = true;
};

/// Draws exactly `count` points, stratified over the total area in the order of instances, with one
/// uniform variate a stratum, so that equal areas get equal numbers to within one. Punctual lights
/// and the environment's points come last. The points are the same for any number of threads.
/// @throws lte::Error if the scene has no area or `count` < 1.
SurfaceSamples sample_surface(const Scene& scene, int64_t count, const SamplerOptions& options);

/// How many of `count` points stand for the environment.
int64_t environment_point_count(const Scene& scene, int64_t count, const SamplerOptions& options);

/// Total world area of a scene, m².
double surface_area(const Scene& scene);

}  // namespace lte::scene
