#include "infer/renderer/path_correction.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "infer/renderer/residual_bands.h"
#include "lte/base/check.h"

namespace lte::infer {
namespace {

using image::Image;

Image difference(const Image& a, const Image& b) {
  Image out = a;
  for (size_t i = 0; i < out.pixels.size(); ++i) out.pixels[i] -= b.pixels[i];
  return out;
}

}  // namespace

Image correct_by_paths(const SurfaceGuides& guides, std::span<const uint8_t> mask,
                       const Image& answer, const Image& half_a, const Image& half_b,
                       const std::function<void()>& check) {
  const auto is_of_size = [&](const Image& image) {
    return image.width == guides.width() && image.height == guides.height() && image.channels == 3;
  };
  LTE_CHECK(is_of_size(answer) && is_of_size(half_a) && is_of_size(half_b) &&
                mask.size() == guides.pixels(),
            "correction by paths: pictures of different sizes");
  std::vector<ResidualHalves> residual;
  residual.push_back({difference(half_a, answer), difference(half_b, answer)});
  Image out = error_of(std::move(residual), {guides.normal, guides.position, mask}, check)[0];
  // A corrected value below 0 is noise. Where that happens the paths' own mean is none, so this
  // keeps what they converge to.
  for (size_t k = 0; k < out.pixels.size(); ++k)
    out.pixels[k] = std::max(out.pixels[k] + answer.pixels[k], 0.0f);
  return out;
}

}  // namespace lte::infer
