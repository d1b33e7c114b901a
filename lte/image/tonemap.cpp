#include "lte/image/tonemap.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "lte/base/parallel.h"
#include "lte/image/srgb_byte.h"

namespace lte::image {
namespace {

/// Magenta: it is seen at once, and hardly ever in a rendering.
constexpr Rgb kInvalid{1, 0, 1};

void check_channels(const Image& picture, const char* who) {
  LTE_CHECK(picture.channels == 1 || picture.channels == 3, who, ": expected 1 or 3 channels, got ",
            picture.channels);
}

Rgb color_at(const Image& picture, int x, int y) {
  const float* p = picture.at(x, y);
  return picture.channels == 1 ? Rgb{p[0], p[0], p[0]} : Rgb{p[0], p[1], p[2]};
}

constexpr int64_t kRowsAtOnce = 16;

/// Before the display curve.
Rgb exposed(const Image& linear, int x, int y, float exposure) {
  const Rgb color = color_at(linear, x, y);
  return is_finite(color) ? color * exposure : kInvalid;
}

/// A new picture of 3 channels with `color(x, y)` in each pixel.
template <typename Color>
Image fill(const Image& like, const Color& color) {
  Image out(like.width, like.height, 3);
  parallel_for(like.height, kRowsAtOnce, [&](int64_t begin, int64_t end) {
    for (auto y = static_cast<int>(begin); y < end; ++y) {
      for (int x = 0; x < like.width; ++x) out.set_rgb(x, y, color(x, y));
    }
  });
  return out;
}

/// Luminances that are positive and finite, of the pixels that an optional mask has.
std::vector<float> luminances(const Image& linear, std::span<const uint8_t> mask) {
  std::vector<float> values;
  values.reserve(linear.pixels.size() / static_cast<size_t>(linear.channels));
  for (int y = 0; y < linear.height; ++y) {
    for (int x = 0; x < linear.width; ++x) {
      const auto i =
          static_cast<size_t>(y) * static_cast<size_t>(linear.width) + static_cast<size_t>(x);
      if (!mask.empty() && mask[i] == 0) continue;
      const float value = luminance(color_at(linear, x, y));
      if (value > 0 && std::isfinite(value)) values.push_back(value);
    }
  }
  return values;
}

}  // namespace

float auto_exposure(const Image& linear, float percentile, float target,
                    std::span<const uint8_t> mask) {
  check_channels(linear, "auto exposure");
  LTE_CHECK(percentile >= 0 && percentile <= 1 && target > 0,
            "auto exposure: expected a percentile in [0, 1] and a "
            "positive target, got ",
            percentile, " and ", target);
  const size_t pixels = static_cast<size_t>(linear.width) * static_cast<size_t>(linear.height);
  LTE_CHECK(mask.empty() || mask.size() == pixels, "auto exposure: expected a mask of ", pixels,
            " pixels, got ", mask.size());
  std::vector<float> values = luminances(linear, mask);
  if (!mask.empty() &&
      static_cast<double>(values.size()) < kMinMetered * static_cast<double>(pixels)) {
    values = luminances(linear, {});
  }
  if (values.empty()) return 1;
  const auto rank =
      std::lround(static_cast<double>(percentile) * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + rank, values.end());
  return std::min(target / values[static_cast<size_t>(rank)], std::numeric_limits<float>::max());
}

Image tonemap(const Image& linear, float exposure) {
  check_channels(linear, "tone mapping");
  return fill(linear, [&](int x, int y) {
    const Rgb color = exposed(linear, x, y, exposure);
    return Rgb{linear_to_srgb(color.x), linear_to_srgb(color.y), linear_to_srgb(color.z)};
  });
}

DisplayPicture display(const Image& linear, float exposure, ToneCurve curve) {
  check_channels(linear, "display");
  DisplayPicture out{linear.width, linear.height, {}};
  const auto row_bytes = size_t{3} * static_cast<size_t>(linear.width);
  out.bytes.resize(row_bytes * static_cast<size_t>(linear.height));
  const SrgbBytes& byte_of = srgb_bytes();
  parallel_for(linear.height, kRowsAtOnce, [&](int64_t begin, int64_t end) {
    for (auto y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      uint8_t* bytes = out.bytes.data() + static_cast<size_t>(y) * row_bytes;
      for (int x = 0; x < linear.width; ++x, bytes += 3) {
        const Rgb light = color_at(linear, x, y);
        const Rgb color = is_finite(light) ? tone_map(curve, light * exposure) : kInvalid;
        for (int c = 0; c < 3; ++c) bytes[c] = byte_of(color[c]);
      }
    }
  });
  return out;
}

Image heat_map(const Image& scalar, float max) {
  LTE_CHECK(scalar.channels == 1, "heat map: expected 1 channel, got ", scalar.channels);
  LTE_CHECK(max >= 0, "heat map: expected a maximum of 0 or more, got ", max);
  constexpr std::array<Rgb, 5> kStops{Rgb{0, 0, 0}, Rgb{0, 0, 1}, Rgb{0, 1, 0}, Rgb{1, 1, 0},
                                      Rgb{1, 0, 0}};
  return fill(scalar, [&](int x, int y) {
    const float value = *scalar.at(x, y);
    if (!std::isfinite(value)) return kInvalid;
    const float place = max > 0 ? 4 * std::clamp(value / max, 0.0f, 1.0f) : 0.0f;
    const size_t stop = std::min<size_t>(3, static_cast<size_t>(place));
    const float blend = place - static_cast<float>(stop);
    return kStops[stop] * (1 - blend) + kStops[stop + 1] * blend;
  });
}

}  // namespace lte::image
