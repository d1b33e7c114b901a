// What a denoiser takes from a picture beside noise.
//
// Two halves of the samples tell how much of the way from the denoised picture to the samples' mean
// is noise. What is left of it the denoiser has smoothed away: shadows' edges, light in a corner.
// The picture goes back to the samples by the share that is not noise, over small surroundings
// (James and Stein's positive part, "Estimation with quadratic loss", 1961). So it comes to the
// truth as samples do, however many there are.
#pragma once

#include <cstdint>
#include <vector>

#include "lte/image/image.h"
#include "lte/render/film.h"

namespace lte::render {

/// Draws denoised light, [height, width, 3], towards the mean of its samples; unchanged where one
/// half has none.
/// @param layer  of the samples: direct or indirect
/// @param mask   [height * width] not 0 in the pixels that take part
void restore_lost_detail(const LightEstimate& samples, image::Image LightSums::*layer,
                         const std::vector<uint8_t>& mask, image::Image* smooth);

}  // namespace lte::render
