// Area-weighted sampling of surface points: the scene points and query points of the paper's
// section 3.2.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "lte/scene/scene.h"
#include "lte/scene/surface.h"

namespace lte::scene {

/// A structure of arrays, one entry a point, in world space.
///
/// Emission leaves the side of the normal. A surface that emits from both sides has points on
/// either, if luminaires have a share: back to back, each with its own normal.
struct SurfaceSamples {
  std::vector<Vec3> position, normal;
  std::vector<Rgb> albedo, emission;
  std::vector<Gloss> gloss;
  std::vector<float> area;       ///< m² that the point stands for
  std::vector<int> light_group;  ///< kNone unless emissive
  /// Unit; empty without SamplerOptions::shading_normals, or without a normal map in the scene.
  std::vector<Vec3> shading_normal;

  int64_t size() const { return static_cast<int64_t>(position.size()); }
  /// Reduces every array to these rows, which ascend.
  void keep(const std::vector<size_t>& rows);
};

struct SamplerOptions {
  uint64_t seed = 0;
  /// Share of points that is guaranteed to emissive surfaces; their `area` stays true. Unless 0,
  /// each luminaire gets at least one point, so that a small one beside a large one is never missed
  /// (as long as that takes no more than half of the points). 0 for plain area weighting, as for
  /// query points.
  double emissive_share = 0.0;
  /// True averages textures over the area that a point stands for (scene points); false samples the
  /// finest level (query points).
  bool filter_footprint = true;
  /// Share of points that stand for the environment of a scene that has one, on the sphere around
  /// it (environment_points.h), so that the network sees it. Unless 0, there is at least one such
  /// point. `emissive_share` is a share of the rest.
  double environment_share = 0.05;
  /// Adds one emissive sample for each point and spot light and each sun (light_points.h).
  bool punctual_lights = true;
  /// Fills in `shading_normal`, from the finest level of normal maps. It goes without
  /// `punctual_lights` and `environment_share`.
  bool shading_normals = false;
};

/// Draws exactly `count` points, stratified over the total area in the order of instances, with one
/// uniform variate a stratum, so that equal areas get equal numbers to within one. Lights that are
/// no surface come last: point and spot lights, suns, the environment. The points are the same for
/// any number of threads. Repeated triangles (repeated_triangles.h) count once.
/// @throws lte::Error if the scene has no area, `count` < 1, or such lights leave no point to the
///         surfaces.
SurfaceSamples sample_surface(const Scene& scene, int64_t count, const SamplerOptions& options);

/// How many of `count` points lie on surfaces; at least 1.
/// @throws lte::Error if lights that are no surface leave none.
int64_t surface_point_count(const Scene& scene, int64_t count, const SamplerOptions& options);

/// Total world area of a scene, m², of one side of its surfaces; repeated triangles count each
/// time.
double surface_area(const Scene& scene);

}  // namespace lte::scene
