// Variance of light at pixels with few paths each, their first directions drawn by the material
// alone or by maps of the radiance decoder too, each pixel's own or shared by neighbours, and
// direct light found by these paths or by light samples (the paper's supplement, section 4).
#pragma once

#include <vector>

#include "experiments/guiding/guiding_row.h"
#include "infer/renderer/renderer.h"
#include "lte/scene/scene.h"

namespace lte::experiments {

/// @param renderer  with an embedding of a radiance decoder
std::vector<GuidingRow> guided_pixels(const infer::Renderer& renderer, const scene::Camera& camera,
                                      const GuidingOptions& options);

}  // namespace lte::experiments
