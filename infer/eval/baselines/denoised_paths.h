// Path tracing with a denoiser, of the views of a data set.
#pragma once

#include <span>
#include <vector>

#include "lte/data/scene_sample.h"
#include "lte/image/denoise.h"

namespace lte::infer {

/// The irradiance of a view without its noise, guided by the normals and positions of its pixels.
/// @param light  of the pixels whose mask is set, in row order
/// @return       the same pixels
std::vector<Rgb> denoised_paths(const image::Denoiser& denoiser, const data::View& view,
                                std::span<const Rgb> light);

}  // namespace lte::infer
