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
/// (lte/pathtrace/incident.h).
struct IncidentBakeOptions {
  int64_t points = 0;    ///< 0 for none
  int64_t bins = 32;     ///< bins × bins directions
  int64_t samples = 64;  ///< paths a direction
};

struct BakeOptions {
  int64_t scene_points = 20000;
  int64_t query_points = 100000;
  int64_t rays = 1024;  ///< paths a query point, unless target_error decides
  /// Standard error of indirect irradiance at query points, relative to its mean over them, that
  /// decides between min_rays and max_rays paths a point (lte/pathtrace/adaptive.h); 0: `rays`
  /// each.
  double target_error = 0;
  int64_t min_rays = 64, max_rays = 4096;
  int max_depth = 5;
  /// Paths a side of a scene point, max_depth deep, for the light that a network reads there
  /// (lte/pathtrace/light_estimates.h).
  int light_paths = data::kDefaultLightPaths;
  bool prune = false;  ///< draw points only where light can reach them (lte/pathtrace/reach.h)
  double emissive_share = 0.1;  ///< of scene points, guaranteed to luminaires
  /// Also bake the rival: 64 independent paths a point, and in views data::kFewPaths as well.
  bool path_tracing_64 = true;
  ViewOptions views;
  IncidentBakeOptions incident;
  /// Views take these in a random order; empty, or once they are used up: automatic cameras.
  std::vector<scene::Camera> view_cameras;
  uint64_t seed = 1;
};

/// @throws lte::Error naming the key that is out of range.
void check_bake_options(const BakeOptions& options);

/// Samples and path-traces. The same sample for the same scene and options, whatever the number of
/// threads.
/// @param show_progress  print points done, rate and time left
/// @param rays  if not null, takes the number of paths that were started, whatever for
/// @throws lte::Error if the scene has no surface or options are out of range.
data::SceneSample bake_scene(const scene::Scene& scene, const BakeOptions& options,
                             bool show_progress, int64_t* rays = nullptr);

}  // namespace lte::datagen
