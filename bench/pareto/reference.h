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

/// Finds the reference of a view, or traces it.
/// @param name    of scene and view, for the line of progress and the file
/// @param spp     paths a pixel, rounded up to an even number
/// @param folder  where references are kept; empty: nowhere
Reference find_reference(const MethodScene& scene, const scene::Camera& camera,
                         const std::string& name, int spp, const std::filesystem::path& folder);

}  // namespace lte::bench
