// From a scene in memory to a scene sample: points, ground truth by light group, views.
#pragma once

#include <cstdint>
#include <vector>

#include "lte/data/dataset.h"
#include "lte/data/scene_sample.h"
#include "lte/scene/scene.h"

namespace lte::datagen {

/// `views:` in the YAML config.
struct ViewOptions {
  int64_t count = 1;
  int64_t width = 96, height = 72;
  int64_t rays = 512;  ///< paths a pixel
};

/// `incident:` in the YAML config: radiance by direction at points of their own
/// (lte/pathtrace/incident/incident.h).
struct IncidentBakeOptions {
  int64_t points = 0;    ///< 0 for none
  int64_t bins = 32;     ///< bins × bins directions
  int64_t samples = 64;  ///< paths a direction
};

struct BakeOptions {
  int64_t scene_points = 20000;
  int64_t query_points = 100000;
  int64_t rays = 1024;  ///< paths a query point, unless target_error decides
  /// If positive, each query point takes as many paths, from min_rays to max_rays, as bring the
  /// standard error of its indirect irradiance to this share of the mean over the query points
  /// (lte/pathtrace/adaptive.h). If 0, each takes `rays`.
  double target_error = 0;
  int64_t min_rays = 64, max_rays = 4096;
  int max_depth = 5;
  /// Paths a side of a scene point, max_depth deep, for the light that a network reads there
  /// (lte/pathtrace/light_estimates.h).
  int light_paths = data::kDefaultLightPaths;
  bool prune = false;  ///< draw points only where light reaches (lte/pathtrace/reach/reach.h)
  double emissive_share = 0.1;  ///< of scene points, guaranteed to luminaires
  /// Also bake path_traced_64, an estimate of 64 paths a point that is independent of the
  /// reference; in views also one with each number of paths in data::kFewPaths.
  bool path_tracing_64 = true;
  ViewOptions views;
  IncidentBakeOptions incident;
  /// Views take these in turn, from one that the seed draws, and automatic cameras once all are
  /// used.
  std::vector<scene::Camera> view_cameras;
  uint64_t seed = 1;
};

/// @throws lte::Error naming the key that is out of range.
void check_bake_options(const BakeOptions& options);

/// Samples and path-traces a scene. The same scene and options give the same sample, whatever the
/// number of threads.
/// @param show_progress  print points done, rate and time left
/// @param rays  if not null, receives the number of paths that were started for any purpose
/// @throws lte::Error if the scene has no surface or options are out of range.
data::SceneSample bake_scene(const scene::Scene& scene, const BakeOptions& options,
                             bool show_progress, int64_t* rays = nullptr);

}  // namespace lte::datagen
