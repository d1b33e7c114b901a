#include "lte/render/combine.h"

#include <algorithm>
#include <cstdint>

#include "lte/base/check.h"
#include "lte/render/box_mean.h"

namespace lte::render {
namespace {

using image::Image;

/// Of the picture's mean: what is darker counts like that where errors are compared.
constexpr float kDark = 0.1f;

/// One over what a pixel shows: errors count relative to it.
std::vector<float> relative_scale(const Image& shown) {
  std::vector<float> out(shown.pixels.size() / 3);
  double sum = 0;
  for (size_t i = 0; i < out.size(); ++i) {
    out[i] = luminance(shown.rgb(i));
    sum += double{out[i]};
  }
  const float dark = kDark * static_cast<float>(sum / static_cast<double>(out.size())) + 1e-30f;
  for (float& value : out) value = 1 / (value + dark);
  return out;
}

}  // namespace

Image combine(const image::Denoiser& denoiser, const DenoisingGuides& guides, const Image& gathered,
              const std::array<Image, 2>& halves) {
  const size_t pixels = gathered.pixels.size() / 3;
  for (const Image* image : {&halves[0], &halves[1], &guides.albedo, &guides.normal})
    LTE_CHECK(image->pixels.size() == 3 * pixels, "combine: pictures of different sizes");
  std::array<Image, 2> smooth;
  for (size_t h = 0; h < 2; ++h) {
    smooth[h] =
        denoiser.denoise({&halves[h], &guides.normal, &guides.position, &guides.albedo, nullptr},
                         image::OidnQuality::Balanced);
  }
  const std::vector<float> scale = relative_scale(gathered);
  std::vector<uint8_t> seen(pixels);
  std::vector<float> along(pixels), square(pixels);
  for (size_t i = 0; i < pixels; ++i) {
    const Vec3 normal = guides.normal.rgb(i);
    seen[i] = normal.x != 0 || normal.y != 0 || normal.z != 0;
    if (!seen[i]) continue;
    const float weight = scale[i] * scale[i];
    for (size_t k = 3 * i; k < 3 * i + 3; ++k) {
      const float from = gathered.pixels[k];
      for (size_t h = 0; h < 2; ++h) {
        const float way = smooth[h].pixels[k] - from;
        along[i] += weight * way * (halves[1 - h].pixels[k] - from);
        square[i] += weight * way * way;
      }
    }
  }
  const BoxMean mean(gathered.width, gathered.height, seen);
  // Twice: the weights of a square of pixels would show its outline around a bright one.
  for (std::vector<float>* sum : {&along, &square})
    *sum = mean(mean(*sum, kCombineWindow / 2), kCombineWindow / 2);
  Image out = gathered;
  for (size_t i = 0; i < pixels; ++i) {
    if (!seen[i] || !(square[i] > 0)) continue;
    const float share = std::clamp(along[i] / square[i], 0.0f, 1.0f);
    for (size_t k = 3 * i; k < 3 * i + 3; ++k) {
      const float to = (smooth[0].pixels[k] + smooth[1].pixels[k]) / 2;
      out.pixels[k] = std::max(0.0f, out.pixels[k] + share * (to - out.pixels[k]));
    }
  }
  return out;
}

}  // namespace lte::render
