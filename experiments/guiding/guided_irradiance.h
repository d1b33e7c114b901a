// Do guided paths make training data cheaper? Irradiance at query points by cosine-distributed
// first directions, as data sets are baked, and by guided ones.
#pragma once

#include <vector>

#include "experiments/guiding/guiding_row.h"
#include "infer/renderer/renderer.h"

namespace lte::experiments {

/// @param renderer  with an embedding of a radiance decoder
std::vector<GuidingRow> guided_irradiance(const infer::Renderer& renderer,
                                          const GuidingOptions& options);

}  // namespace lte::experiments
