// The light of texels from two halves of noisy samples.
//
// It is the estimator of pictures (lte/render/combine.h) on a graph of texels. Each half is
// smoothed by itself: by the denoiser of the atlas where there is one (atlas_denoiser.h), else by a
// wide mean over neighbours. What that has lost, at the borders of charts too, means of the rest
// bring back, and so do paths where gathered light is off. The other half, whose noise it does not
// share, tells without bias how far each way goes towards the truth: the weights are those of least
// squared error, over a texel's surroundings.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "lte/bake/texel_graph.h"
#include "lte/base/math.h"

namespace lte::bake {

/// An entry a texel.
using Halves = std::array<std::vector<Rgb>, 2>;

/// Takes noise out of light at all texels; may be empty.
using Denoise = std::function<std::vector<Rgb>(const std::vector<Rgb>& light)>;

/// Smooths the halves of one estimate.
/// @param samples  means of each half's own samples, W/m²
/// @return  of each half; their mean is the estimate
Halves smooth(const TexelGraph& graph, const Halves& samples, const Denoise& denoise = {});

/// Draws an estimate towards other samples of the same light that have no bias.
Halves correct(const TexelGraph& graph, Halves estimate, const Halves& samples,
               const Denoise& denoise = {});

/// Root of the mean squared error over the mean square of light, as the halves' difference tells
/// it, luminance.
double relative_error(const Halves& estimate);

}  // namespace lte::bake
