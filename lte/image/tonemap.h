// Tone mapping: from linear radiance to the display.
#pragma once

#include <cstdint>
#include <span>

#include "lte/base/srgb.h"
#include "lte/image/display_picture.h"
#include "lte/image/image.h"
#include "lte/image/tone_curve.h"

namespace lte::image {

using lte::linear_to_srgb;
using lte::srgb_to_linear;

/// The exposure that brings the `percentile` of luminance over positive finite pixels to `target`;
/// 1 for a black image.
/// @param mask  [width * height], 0 for pixels that are not to be metered, such as sky; empty: all
///              are. It is passed over where it leaves less than kMinMetered of the picture.
float auto_exposure(const Image& linear, float percentile = 0.95f, float target = 0.8f,
                    std::span<const uint8_t> mask = {});

/// A thing that is smaller in the picture does not rule its exposure.
inline constexpr double kMinMetered = 0.01;

/// Puts clamp(exposure * linear) through the sRGB curve, into 3 channels (a one-channel image gives
/// gray). A pixel that is not finite becomes magenta, so that it is seen.
Image tonemap(const Image& linear, float exposure);

/// Exposed light through a tone curve and sRGB, rounded to 8 bits. With the linear curve it is
/// tonemap(), and magenta is the same.
DisplayPicture display(const Image& linear, float exposure, ToneCurve curve = ToneCurve::Linear);

/// False colors (black, blue, green, yellow, red) of a one-channel image over [0, max]; magenta
/// where it is not finite.
Image heat_map(const Image& scalar, float max);

}  // namespace lte::image
