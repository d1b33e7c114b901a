// What a denoiser takes from a picture beside noise.
//
// Two halves of the samples tell how much of the way from the denoised picture to the samples' mean
// is noise. What is left of it the denoiser has smoothed away: shadows' edges, light in a corner.
// The picture goes back to the samples by the share that is not noise, over small surroundings
// (James and Stein's positive part, "Estimation with quadratic loss", 1961). So it comes to the
// truth as samples do, however many there are.
#pragma once

#include "lte/image/image.h"
#include "lte/render/film.h"

namespace lte::render {

/// Draws denoised light, [height, width, 3], towards the mean of the samples of Film::gathered;
/// unchanged where one half has none, and where metal is seen.
/// @param layer  direct or indirect
void restore_lost_detail(const Film& film, image::Image LightSums::*layer, image::Image* smooth);

}  // namespace lte::render
