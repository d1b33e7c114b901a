// A frame from its parts: light layers, bands of rows.
#pragma once

#include "infer/picture/frame.h"
#include "infer/picture/output.h"
#include "lte/pathtrace/render.h"

namespace lte::infer {

/// The chosen picture from the layers of a frame.
image::Image compose(const Frame& frame, Output output);

/// What a pixel has in the layers of a frame; 0 in those that are not there.
struct PixelLayers {
  Rgb albedo, emission, direct, indirect, total;
};

/// compose() of one pixel, to the bit, for outputs that show light.
inline Rgb color_of(const PixelLayers& pixel, Output output) {
  if (output == Output::Irradiance) return pixel.indirect;
  Rgb out = output == Output::Full ? pixel.emission : Rgb{};
  if (output != Output::Gi) out += pixel.albedo * pixel.direct / kPi;
  if (output == Output::Direct) return out;
  out += pixel.albedo * pixel.indirect / kPi;
  return out + pixel.albedo * pixel.total / kPi;
}

/// Turns the reference's radiance into light layers under which the sum of layers is the picture.
void put_radiance(pathtrace::RadianceLayers layers, Frame* frame);

/// Copies the rows of a band, which begin at row `first`, into a frame of `height` rows, and adds
/// its counts. Images are made where they are missing.
/// @param layers  copy more than color and depth
void put_band(const Frame& band, int first, bool layers, int height, Frame* frame);

}  // namespace lte::infer
