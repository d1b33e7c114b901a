#include "infer/renderer/shared_denoiser.h"

#include "lte/base/log.h"

namespace lte::infer {

const image::Denoiser& SharedDenoiser::get() {
  const std::lock_guard lock(mutex_);
  if (!denoiser_) {
    denoiser_.emplace();
    log_info("denoising by ", denoiser_->description());
  }
  return *denoiser_;
}

}  // namespace lte::infer
