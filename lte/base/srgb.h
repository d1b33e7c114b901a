// The transfer curve of displays.
#pragma once

#include <cmath>

namespace lte {

/// The sRGB transfer curve (IEC 61966-2-1) of a value clamped to [0, 1], and its inverse; NaN is 0.
inline float linear_to_srgb(float linear) {
  if (!(linear > 0)) return 0;
  if (linear >= 1) return 1;
  return linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1 / 2.4f) - 0.055f;
}
inline float srgb_to_linear(float encoded) {
  if (!(encoded > 0)) return 0;
  if (encoded >= 1) return 1;
  return encoded <= 0.04045f ? encoded / 12.92f : std::pow((encoded + 0.055f) / 1.055f, 2.4f);
}

}  // namespace lte
