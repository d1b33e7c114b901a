#include "lte/render/shared_denoiser.h"

#include "lte/base/log.h"

namespace lte::render {
namespace {

/// A denoiser that has denoised: the first picture takes some hundredths of a second more.
image::Denoiser open_warm(image::OidnQuality quality) {
  image::Denoiser out;
  constexpr int kSide = 16;
  image::Image light(kSide, kSide, 3), normal(kSide, kSide, 3);
  for (size_t i = 0; i < light.pixels.size(); ++i) light.pixels[i] = normal.pixels[i] = 0.5f;
  if (out.is_oidn()) out.denoise({&light, &normal, nullptr, nullptr, nullptr}, quality);
  return out;
}

}  // namespace

void SharedDenoiser::prepare(image::OidnQuality quality) {
  const std::lock_guard lock(mutex_);
  if (denoiser_ || opening_.valid()) return;
  opening_ = std::async(std::launch::async, open_warm, quality);
}

const image::Denoiser& SharedDenoiser::get() {
  const std::lock_guard lock(mutex_);
  if (!denoiser_) {
    if (opening_.valid()) {
      denoiser_.emplace(opening_.get());
    } else {
      denoiser_.emplace();
    }
    log_info("denoising by ", denoiser_->description());
  }
  return *denoiser_;
}

}  // namespace lte::render
