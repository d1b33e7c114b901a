#include "lte/render/combine.h"

#include <cstdint>

#include "lte/base/check.h"
#include "lte/render/box_mean.h"
#include "lte/render/way_regression.h"

namespace lte::render {
namespace {

using image::Image;

std::vector<float> luminances(const Image& image) {
  std::vector<float> out(image.pixels.size() / 3);
  for (size_t i = 0; i < out.size(); ++i) out[i] = luminance(image.rgb(i));
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
  const std::vector<float> weight = error_weights(luminances(gathered));
  std::vector<uint8_t> seen(pixels);
  WayRegression regression(pixels);
  for (size_t i = 0; i < pixels; ++i) {
    seen[i] = guides.normal.rgb(i) != Vec3{};
    for (size_t h = 0; seen[i] && h < 2; ++h)
      regression.add(i, weight[i], gathered.rgb(i), smooth[h].rgb(i), halves[1 - h].rgb(i));
  }
  const BoxMean mean(gathered.width, gathered.height, seen);
  // Twice: the weights of a square of pixels would show its outline around a bright one.
  regression.spread([&](std::vector<float> sum) {
    return mean(mean(sum, kCombineWindow / 2), kCombineWindow / 2);
  });
  Image out = gathered;
  for (size_t i = 0; i < pixels; ++i) {
    if (!seen[i]) continue;
    const Rgb to = (smooth[0].rgb(i) + smooth[1].rgb(i)) * 0.5f;
    out.set_rgb(i, regression.draw(i, gathered.rgb(i), to));
  }
  return out;
}

}  // namespace lte::render
