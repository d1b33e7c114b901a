#include "infer/renderer/checked_pixels.h"

#include <algorithm>
#include <cmath>

#include "lte/base/random.h"
#include "lte/scene/scene.h"

namespace lte::infer {
namespace {

constexpr double kMostPixels = 1 << 16;

}  // namespace

CheckedPixels::CheckedPixels(int width, int height, uint64_t seed)
    : width_(width),
      square_(static_cast<int>(
          std::ceil(std::sqrt(std::max(1.0, double{1} * width * height / kMostPixels))))),
      seed_(seed) {}

void CheckedPixels::take(const PictureBand& band, const PictureRows& rows, const BandLight& light,
                         const pathtrace::GBuffer* hits, int first_row) {
  const image::Image* known =
      light.centres.total != nullptr ? light.centres.total : light.centres.indirect;
  const auto& asked = light.total ? light.total : light.indirect;
  if (hits != nullptr ? known == nullptr : !asked.has_value()) return;
  answers_.total = hits != nullptr ? light.centres.total != nullptr : light.total.has_value();
  for (int top = rows.first / square_ * square_; top < rows.last; top += square_) {
    for (int left = 0; left < width_; left += square_) {
      Rng rng(seed_, static_cast<uint64_t>(int64_t{top} * width_ + left));
      const int y = top + static_cast<int>(rng.below(static_cast<uint64_t>(square_)));
      const int x = left + static_cast<int>(rng.below(static_cast<uint64_t>(square_)));
      if (y < rows.first || y >= rows.last || x >= width_) continue;
      const int64_t pixel = int64_t{y} * width_ + x;
      const int32_t query =
          band.query_of_pixel()[static_cast<size_t>(pixel - int64_t{rows.first} * width_)];
      if (query == scene::kNone) continue;
      if (hits != nullptr) {
        const auto at = static_cast<size_t>(pixel - int64_t{first_row} * width_);
        answers_.add(hits->position[at], hits->normal[at], known->rgb(at));
      } else {
        const auto at = static_cast<size_t>(query);
        answers_.add(band.queries().position[at], band.queries().normal[at], (*asked)[at]);
      }
      pixel_.push_back(pixel);
    }
  }
}

void CheckedPixels::correct(const PictureRows& rows, const Frame& frame) {
  if (frame.indirect.width == 0) return;
  const int64_t first = int64_t{rows.first} * width_, last = int64_t{rows.last} * width_;
  for (size_t i = 0; i < pixel_.size(); ++i) {
    if (pixel_[i] >= first && pixel_[i] < last)
      answers_.irradiance[i] = frame.indirect.rgb(static_cast<size_t>(pixel_[i] - first));
  }
}

}  // namespace lte::infer
