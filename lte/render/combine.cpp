#include "lte/render/combine.h"

#include <cstdint>

#include "lte/base/check.h"
#include "lte/render/box_mean.h"
#include "lte/render/way_regression.h"

namespace lte::render {
namespace {

using image::Image;

/// Of one of the two means, and one over the sum of squared weights of both.
constexpr float kEdge = kCombineWindow + 1;
constexpr float kWeightOfLine = 3 * kEdge * kEdge * kEdge / (2 * kEdge * kEdge + 1);
constexpr float kWindowPixels = kWeightOfLine * kWeightOfLine;

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
  std::vector<float> noise(pixels);
  for (size_t i = 0; i < pixels; ++i) {
    seen[i] = guides.normal.rgb(i) != Vec3{};
    for (size_t h = 0; seen[i] && h < 2; ++h)
      regression.add(i, weight[i], gathered.rgb(i), smooth[h].rgb(i), halves[1 - h].rgb(i));
    noise[i] = regression.along[i] * regression.along[i];
  }
  const auto share = static_cast<float>(regression.expected_share(noise));
  const BoxMean mean(gathered.width, gathered.height, seen);
  // Twice: the weights of a square of pixels would show its outline around a bright one.
  std::vector<float> counts;
  const auto window = [&](const std::vector<float>& values) {
    return mean(mean(values, kCombineWindow / 2, &counts), kCombineWindow / 2);
  };
  regression.spread(window);
  noise = window(noise);
  Image out = gathered;
  for (size_t i = 0; i < pixels; ++i) {
    if (!seen[i]) continue;
    regression.shrink(i, share, noise[i] * kEdge * kEdge / (kWindowPixels * counts[i]));
    const Rgb to = (smooth[0].rgb(i) + smooth[1].rgb(i)) * 0.5f;
    out.set_rgb(i, regression.draw(i, gathered.rgb(i), to));
  }
  return out;
}

}  // namespace lte::render
