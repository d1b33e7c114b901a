// The network's picture of a view and that of a few paths, in one.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lte/base/math.h"
#include "lte/data/scene_sample.h"

namespace lte::infer {

/// Draws the network's picture towards one of paths without their noise. The network errs over
/// whole surfaces, which few paths tell; a denoiser errs at edges, which the network, asked pixel
/// by pixel, knows. So the way goes by what both differ by around a pixel, in the mean of 3 × 3
/// with the weights 1, 2, 1, and n/(n + 2) of it: about the share of least FLIP, whatever n is
/// (docs/lab/learning.md).
/// @param network, clean  of the pixels whose mask is set, in row order
/// @param paths           n, behind each pixel of `clean`
/// @return                of the same pixels, not negative where both are not
std::vector<Rgb> drawn_to_paths(const data::View& view, std::span<const Rgb> network,
                                std::span<const Rgb> clean, int paths);

}  // namespace lte::infer
