// Two estimates of a picture's light made one: what an integrator gathered at points, which is
// smooth and may be wrong by some per cent over wide areas, and what paths through the pixels
// found, which is right and noisy.
//
// Each half of the paths is denoised by itself. The other half, whose noise it does not share, then
// tells without bias how far the way from the gathered picture to the denoised paths goes towards
// the truth: the weights are those of least squared error (linear regression), in squares of
// kCombineWindow pixels.
#pragma once

#include <array>
#include <vector>

#include "lte/image/denoise.h"
#include "lte/render/film.h"

namespace lte::render {

/// Half an edge of the square over which weights are estimated, the middle counting most.
inline constexpr int kCombineWindow = 16;

/// What guides a denoiser, of the film's size: means over pixels; normals are 0 in the background.
struct DenoisingGuides {
  image::Image albedo, normal, position;
};

/// Reflected light, direct and indirect in one, [height, width, 3] radiance: the gathered picture
/// drawn towards the paths.
/// @param gathered  without noise
/// @param halves    of the paths, noisy
image::Image combine(const image::Denoiser& denoiser, const DenoisingGuides& guides,
                     const image::Image& gathered, const std::array<image::Image, 2>& halves);

}  // namespace lte::render
