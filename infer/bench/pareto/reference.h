// What pictures of the chart are compared with: a path-traced picture of each view, kept in a
// folder from one run to the next.
#pragma once

#include <filesystem>
#include <string>

#include "infer/bench/pareto/method.h"
#include "infer/picture/picture_score.h"

namespace lte::infer {

struct Reference {
  image::Image whole, indirect;
  /// Estimated from two halves of the paths. That of relMSE leaves out what noise does to the
  /// denominator.
  ReferenceNoise whole_noise, indirect_noise;
};

struct ReferenceSettings {
  int spp = 2048;               ///< paths a pixel, rounded up to an even number
  std::filesystem::path cache;  ///< folder; empty: nothing is kept
};

/// Reads the reference of a view, or traces and keeps it. The file is named by scene, size, paths
/// and a fingerprint: a hash of the same view with one path a pixel, in which any change of scene,
/// camera, depth or path tracer shows.
/// @param name  of scene and view, for the file
Reference find_reference(const MethodScene& scene, const scene::Camera& camera,
                         const std::string& name, const ReferenceSettings& settings);

}  // namespace lte::infer
