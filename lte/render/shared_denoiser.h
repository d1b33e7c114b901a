// A denoiser that is opened when it is first needed: some tenths of a second, which renderers of
// one process need not spend each.
#pragma once

#include <future>
#include <mutex>
#include <optional>

#include "lte/image/denoise.h"

namespace lte::render {

/// Thread-safe.
class SharedDenoiser {
 public:
  const image::Denoiser& get();
  /// Opens it in another thread, for who will need it soon: while a scene is read, processors wait.
  void prepare(image::OidnQuality quality);

 private:
  std::mutex mutex_;
  std::future<image::Denoiser> opening_;
  std::optional<image::Denoiser> denoiser_;
};

}  // namespace lte::render
