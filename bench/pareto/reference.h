// What pictures of the chart are compared with: the mean of both pictures of a reference_pair.h.
#pragma once

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

/// Traces the reference of a view.
/// @param name  of scene and view, for the line of progress
/// @param spp   paths a pixel, rounded up to an even number
Reference trace_reference(const MethodScene& scene, const scene::Camera& camera,
                          const std::string& name, int spp);

}  // namespace lte::bench
