// One picture of a view from the network's and from a few denoised paths.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lte/base/math.h"
#include "lte/data/scene_sample.h"

namespace lte::infer {

/// Adds n/(n + 2) of the difference of both pictures to the network's, the difference averaged over
/// 3 × 3 pixels with the weights 1, 2, 1. The network errs over whole surfaces, which few paths
/// correct; a denoiser errs at edges, which the network answers pixel by pixel. The share is about
/// that of least FLIP for every n.
/// @param network, clean  of the pixels whose mask is set, in row order
/// @param paths           n, behind each pixel of `clean`
/// @return                the same pixels, not negative where both are not
std::vector<Rgb> combine(const data::View& view, std::span<const Rgb> network,
                         std::span<const Rgb> clean, int paths);

}  // namespace lte::infer
