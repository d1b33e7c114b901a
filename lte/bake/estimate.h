// The light of texels from two halves of noisy samples: means over neighbours as wide as the light
// is even there, and no wider.
//
// It is the estimator of pictures (lte/render/combine.h) on a graph of texels. Each half is
// smoothed by itself; the other half, whose noise it does not share, tells without bias how far the
// way from a wide mean to a narrower one, or from gathered light to what paths found, goes towards
// the truth: the weights are those of least squared error, over a texel's surroundings.
#pragma once

#include <array>
#include <vector>

#include "lte/bake/texel_graph.h"
#include "lte/base/math.h"

namespace lte::bake {

/// An entry a texel.
using Halves = std::array<std::vector<Rgb>, 2>;

/// Smooths the halves of one estimate.
/// @param samples  means of each half's own samples, W/m²
/// @return  of each half; their mean is the estimate
Halves smooth(const TexelGraph& graph, const Halves& samples);

/// Draws an estimate towards other samples of the same light that have no bias.
Halves correct(const TexelGraph& graph, Halves estimate, const Halves& samples);

/// Root of the mean squared error over the mean square of light, as the halves' difference tells
/// it, luminance.
double relative_error(const Halves& estimate);

}  // namespace lte::bake
