// A film's picture: means over samples, the two estimates of its light combined, noise taken out.
#pragma once

#include "lte/image/denoise.h"
#include "lte/render/film.h"
#include "lte/render/frame.h"

namespace lte::render {

struct PictureSettings {
  Output output = Output::Full;
  /// Takes noise out of light, direct and indirect together, whose ratio in a pixel stays; null:
  /// noise stays.
  const image::Denoiser* denoiser = nullptr;
  image::OidnQuality quality = image::OidnQuality::High;
};

/// The film as it is now, which may go on afterwards.
/// @param film  of RenderSettings::irradiance for Output::Irradiance, and of no other output
Frame make_picture(const Film& film, const PictureSettings& settings);

/// The chosen picture from the layers of a frame.
image::Image compose(const Frame& frame, Output output);

}  // namespace lte::render
