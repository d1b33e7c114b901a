#include "lte/render/half_size.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "lte/base/parallel.h"
#include "lte/render/edges.h"

namespace lte::render {
namespace {

using image::Image;

constexpr int64_t kRows = 4;
/// Of bilinear weight, below which the means on a pixel's surface do not stand for it.
constexpr float kMinWeight = 0.1f;
constexpr int kIsolatedRadius = 3;  // in pixels

/// Calls use(x, y), in several threads.
template <typename Use>
void for_places(int width, int height, const Use& use) {
  parallel_for(height, kRows, [&](int64_t begin, int64_t end) {
    for (auto y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      for (int x = 0; x < width; ++x) use(x, y);
    }
  });
}

class Halved {
 public:
  Halved(const Film& film, const Image& light)
      : film_(film),
        light_(light),
        mean_((film.width + 1) / 2, (film.height + 1) / 2, 3),
        normal_(mean_),
        position_(mean_) {
    for_places(mean_.width, mean_.height, [this](int x, int y) { average(x, y); });
  }

  Image denoised(const image::Denoiser& denoiser, image::OidnQuality quality) {
    mean_ = denoiser.denoise({&mean_, &normal_, &position_, nullptr, nullptr}, quality);
    Image out(film_.width, film_.height, 3);
    for_places(out.width, out.height, [&](int x, int y) {
      const size_t pixel = film_.number(x, y);
      if (film_.is_lit(pixel)) out.set_rgb(pixel, at(x, y, film_.center(pixel)));
    });
    return out;
  }

 private:
  /// The mean of those pixels of a square that see what the first of them sees.
  void average(int x, int y) {
    const size_t mean = mean_.number(x, y);
    Rgb sum;
    float count = 0;
    SurfacePlace first;
    for (int k = 0; k < 4; ++k) {
      const int px = 2 * x + k % 2, py = 2 * y + k / 2;
      if (px >= film_.width || py >= film_.height) continue;
      const size_t pixel = film_.number(px, py);
      if (!film_.is_lit(pixel)) continue;
      const SurfacePlace place = film_.center(pixel);
      if (count == 0) first = place;
      if (!shares_light(first, place)) continue;
      sum += light_.rgb(pixel);
      ++count;
    }
    if (count == 0) return;
    mean_.set_rgb(mean, sum * (1 / count));
    position_.set_rgb(mean, first.position);
    normal_.set_rgb(mean, first.normal);
  }

  Rgb at(int x, int y, const SurfacePlace& place) const {
    const float u = 0.5f * static_cast<float>(x) - 0.25f, v = 0.5f * static_cast<float>(y) - 0.25f;
    const auto left = static_cast<int>(std::floor(u)), top = static_cast<int>(std::floor(v));
    const float across = u - static_cast<float>(left), down = v - static_cast<float>(top);
    Rgb sum;
    float weight = 0;
    for (int k = 0; k < 4; ++k) {
      const int mx = std::clamp(left + k % 2, 0, mean_.width - 1),
                my = std::clamp(top + k / 2, 0, mean_.height - 1);
      const size_t mean = mean_.number(mx, my);
      if (!shares_light(place, {position_.rgb(mean), normal_.rgb(mean), place.tolerance})) continue;
      const float w = (k % 2 == 1 ? across : 1 - across) * (k / 2 == 1 ? down : 1 - down);
      sum += mean_.rgb(mean) * w;
      weight += w;
    }
    return weight > kMinWeight ? sum * (1 / weight) : alone(x, y, place);
  }

  Rgb alone(int x, int y, const SurfacePlace& place) const {
    Rgb sum;
    float count = 0;
    for (int py = std::max(0, y - kIsolatedRadius);
         py <= std::min(film_.height - 1, y + kIsolatedRadius); ++py) {
      for (int px = std::max(0, x - kIsolatedRadius);
           px <= std::min(film_.width - 1, x + kIsolatedRadius); ++px) {
        const size_t pixel = film_.number(px, py);
        if (!film_.is_lit(pixel) || !shares_light(place, film_.center(pixel))) continue;
        sum += light_.rgb(pixel);
        ++count;
      }
    }
    return sum * (1 / std::max(1.0f, count));
  }

  const Film& film_;
  const Image& light_;
  Image mean_, normal_, position_;
};

}  // namespace

Image denoise_at_half_size(const Film& film, const Image& light, const image::Denoiser& denoiser,
                           image::OidnQuality quality) {
  return Halved(film, light).denoised(denoiser, quality);
}

}  // namespace lte::render
