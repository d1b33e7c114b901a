// A denoiser that is opened when it is first needed: some tenths of a second, which renderers of
// one process need not spend each.
#pragma once

#include <mutex>
#include <optional>

#include "lte/image/denoise.h"

namespace lte::infer {

/// Thread-safe.
class SharedDenoiser {
 public:
  const image::Denoiser& get();

 private:
  std::mutex mutex_;
  std::optional<image::Denoiser> denoiser_;
};

}  // namespace lte::infer
