// A film's picture: means over samples, the two estimates of its light combined, noise taken out.
#pragma once

#include "lte/image/denoise.h"
#include "lte/render/film.h"
#include "lte/render/frame.h"

namespace lte::render {

struct PictureSettings {
  Output output = Output::Full;
  const image::Denoiser* denoiser = nullptr;  ///< of light; null: noise stays
  image::OidnQuality quality = image::OidnQuality::High;
  /// Output::Full: direct and indirect light are wanted apart (Frame). Where there is noise to take
  /// out of both, this takes two runs of the denoiser more.
  bool layers = true;
};

/// The film as it is now, which may go on afterwards.
/// @param film  of RenderSettings::irradiance for Output::Irradiance, and of no other output
Frame make_picture(const Film& film, const PictureSettings& settings);

/// The chosen picture from the layers of a frame.
image::Image compose(const Frame& frame, Output output);

}  // namespace lte::render
