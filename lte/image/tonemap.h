// From linear radiance to the display.
#pragma once

#include "lte/image/image.h"

namespace lte::image {

/// The sRGB transfer curve (IEC 61966-2-1) of a value clamped to [0, 1], and its inverse.
float linear_to_srgb(float linear);
float srgb_to_linear(float encoded);

/// Exposure that brings the `percentile` of luminance over positive finite pixels to `target`; 1
/// for a black image.
float auto_exposure(const Image& linear, float percentile = 0.95f, float target = 0.8f);

/// clamp(exposure * linear) through the sRGB curve, 3 channels (a one-channel image gives grey); a
/// non-finite pixel becomes magenta so that it is seen.
Image tonemap(const Image& linear, float exposure);

/// False colour (black-blue-green-yellow-red) of a one-channel image over [0, max]; magenta where
/// it is not finite.
Image heat_map(const Image& scalar, float max);

}  // namespace lte::image
