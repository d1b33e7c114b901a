#include "infer/view/display_layers.h"

#include <algorithm>
#include <cmath>

#include "lte/base/parallel.h"
#include "lte/image/srgb_byte.h"
#include "lte/image/tonemap.h"

namespace lte::infer::view {
namespace {

constexpr int64_t kRowsAtOnce = 32;
// A difference of this much of the display's range has its full color.
constexpr float kFullDifference = 0.25f;

/// Calls `pixel(rgb, bytes)` for every pixel.
template <typename Pixel>
DisplayPicture map_pixels(const image::Image& picture, const Pixel& pixel) {
  DisplayPicture out{picture.width, picture.height, {}};
  out.bytes.resize(size_t{3} * static_cast<size_t>(picture.width) *
                   static_cast<size_t>(picture.height));
  parallel_for(picture.height, kRowsAtOnce, [&](int64_t first, int64_t last) {
    for (int y = static_cast<int>(first); y < static_cast<int>(last); ++y) {
      for (int x = 0; x < picture.width; ++x)
        pixel(x, y, out.bytes.data() + 3 * (size_t(y) * size_t(picture.width) + size_t(x)));
    }
  });
  return out;
}

}  // namespace

DisplayPicture display_albedo(const image::Image& albedo) { return image::display(albedo, 1); }

DisplayPicture display_normal(const image::Image& normal) {
  return map_pixels(normal, [&](int x, int y, uint8_t* bytes) {
    const Vec3 n = normal.rgb(x, y);
    for (int c = 0; c < 3; ++c) {
      const float value = dot(n, n) > 0 ? std::clamp(0.5f * n[c] + 0.5f, 0.0f, 1.0f) : 0;
      bytes[c] = static_cast<uint8_t>(std::lround(255 * value));
    }
  });
}

DisplayPicture display_difference(const image::Image& light, const image::Image& reference,
                                  float exposure) {
  const image::SrgbBytes& byte_of = image::srgb_bytes();
  return map_pixels(light, [&](int x, int y, uint8_t* bytes) {
    const float off = exposure * luminance(light.rgb(x, y) - reference.rgb(x, y));
    if (!std::isfinite(off)) {
      bytes[0] = bytes[2] = 255;
      return;
    }
    const float share = std::min(std::abs(off) / kFullDifference, 1.0f);
    const Rgb tint = off > 0 ? Rgb{0.95f, 0.25f, 0.10f} : Rgb{0.10f, 0.40f, 1.0f};
    for (int c = 0; c < 3; ++c) bytes[c] = byte_of(tint[c] * share);
  });
}

}  // namespace lte::infer::view
