#include "infer/renderer/pixel_paths.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "lte/base/random.h"

namespace lte::infer {
namespace {

using image::Image;
using pathtrace::RadianceLayers;

/// Pixels whose radiance is there at once beside the sums.
constexpr size_t kPixelsAtOnce = size_t{1} << 16;

void add_mean(Image* sum, size_t pixel, const Rgb& mean, int paths) {
  sum->set_rgb(pixel, sum->rgb(pixel) + mean * static_cast<float>(paths));
}

}  // namespace

PixelPaths::PixelPaths(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                       const scene::Camera& camera, const PictureRows& rows, int max_depth,
                       uint64_t seed)
    : bvh_(bvh), lights_(lights), camera_(camera), rows_(rows), max_depth_(max_depth), seed_(seed) {
  const Image black(rows.width, rows.last - rows.first, 3);
  halves_.fill({black, black, black});
  paths_.resize(black.pixels.size() / 3);
}

void PixelPaths::add(std::span<const int64_t> pixels, int paths) {
  const int64_t first = int64_t{rows_.first} * rows_.width;
  std::vector<int64_t> of_picture;
  for (uint64_t h = 0; h < halves_.size(); ++h) {
    const uint64_t seed = hash_combine(hash_combine(seed_, passes_), h);
    RadianceLayers& half = halves_[h];
    for (size_t begin = 0; begin < pixels.size(); begin += kPixelsAtOnce) {
      const auto part = pixels.subspan(begin, std::min(kPixelsAtOnce, pixels.size() - begin));
      of_picture.assign(part.begin(), part.end());
      for (int64_t& pixel : of_picture) pixel += first;
      const std::vector<pathtrace::PixelRadiance> seen =
          pathtrace::trace_pixels(bvh_, lights_, camera_, rows_.width, rows_.height, of_picture,
                                  {paths, max_depth_ + 1, seed});
      for (size_t i = 0; i < part.size(); ++i) {
        const auto pixel = static_cast<size_t>(part[i]);
        add_mean(&half.emission, pixel, seen[i].emission, paths);
        add_mean(&half.direct, pixel, seen[i].direct, paths);
        add_mean(&half.indirect, pixel, seen[i].indirect, paths);
      }
    }
  }
  for (const int64_t pixel : pixels) paths_[static_cast<size_t>(pixel)] += paths;
  ++passes_;
}

std::array<RadianceLayers, 2> PixelPaths::take() {
  for (RadianceLayers& half : halves_) {
    for (Image* sum : {&half.emission, &half.direct, &half.indirect}) {
      for (size_t k = 0; k < sum->pixels.size(); ++k)
        sum->pixels[k] /= static_cast<float>(std::max(1, paths_[k / 3]));
    }
  }
  return std::move(halves_);
}

double PixelPaths::mean_paths() const {
  const auto sum = std::accumulate(paths_.begin(), paths_.end(), int64_t{0});
  return 2 * static_cast<double>(sum) / static_cast<double>(paths_.size());
}

}  // namespace lte::infer
