// What pictures of the chart are compared with: the mean of both pictures of a reference_pair.h.
#pragma once

#include <filesystem>
#include <string>

#include "bench/pareto/methods.h"
#include "infer/picture/picture_score.h"

namespace lte::bench {

struct Reference {
  image::Image whole, indirect;
  /// Estimated from two halves of the paths. That of relMSE leaves out what noise does to the
  /// denominator.
  infer::ReferenceNoise whole_noise, indirect_noise;
};

struct ReferenceSettings {
  int spp = 2048;               ///< paths a pixel, rounded up to an even number
  std::filesystem::path cache;  ///< folder; empty: nothing is kept
};

/// Reads the reference of a view, or traces and keeps it.
/// @param name  of scene and view, for the file
/// @throws ReferenceFault
Reference find_reference(const MethodScene& scene, const scene::Camera& camera,
                         const std::string& name, const ReferenceSettings& settings);

}  // namespace lte::bench
