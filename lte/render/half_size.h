// Noise taken out of light at half the picture's size.
//
// Light that surfaces have reflected changes slowly over a surface. Of two by two pixels those that
// see one surface make a mean, which has half the noise and is filtered over twice the distance in
// a quarter of the time; pixels take it from the means around that lie on their surface (joint
// bilateral upsampling, Kopf et al. 2007). What no mean stands for, narrow things, takes the mean
// of the pixels around on its surface.
#pragma once

#include "lte/image/denoise.h"
#include "lte/render/film.h"

namespace lte::render {

/// @param light  irradiance at the surfaces of pixels' centers, [height, width, 3]
image::Image denoise_at_half_size(const Film& film, const image::Image& light,
                                  const image::Denoiser& denoiser, image::OidnQuality quality);

}  // namespace lte::render
