#include "infer/renderer/quality.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace lte::infer {
namespace {

/// Paths of a pixel that a pass has at most: they are stratified together, and progress is shown
/// between passes.
constexpr int kPathsAPass = 256;

/// Passes whose rays a draft gathers in its one: a tenth more time for a fifth less error.
constexpr int kDraftPasses = 2;

/// Rays of a preview, in each pixel twice to eight times a pass's: the denoiser joins what lies
/// near in the picture, so that a pixel of a large one needs fewer.
constexpr int64_t kPreviewRays = 1'300'000;
constexpr int64_t kMinPasses = 2, kMaxPasses = 8;

/// Of a pixel, as a final picture has: record_paths().
constexpr int kManyRays = 32;

/// Passes whose rays a preview gathers in its one.
int preview_passes(const RenderSettings& settings) {
  const int64_t rays = int64_t{settings.width} * settings.height * settings.gather_rays;
  return static_cast<int>(
      std::clamp(kPreviewRays / std::max<int64_t>(rays, 1), kMinPasses, kMaxPasses));
}

}  // namespace

RenderSettings with_quality(Quality quality, RenderSettings settings) {
  switch (quality) {
    case Quality::Draft:
      settings.passes = 1;
      settings.gather_rays *= kDraftPasses;
      settings.light_samples *= kDraftPasses;
      settings.denoise_quality = image::OidnQuality::Fast;
      break;
    case Quality::Preview:
      // One pass: what samples of a point are stratified together is worth more than jitter. Where
      // rays are as many as light samples, they complete each other (lte/render/gather.cpp).
      settings.passes = 1;
      settings.gather_rays *= preview_passes(settings);
      settings.light_samples *= static_cast<int>(kMaxPasses);
      settings.denoise_quality = image::OidnQuality::Balanced;
      break;
    case Quality::Final:
      settings.passes = 16;
      settings.denoise_quality = image::OidnQuality::High;
      break;
  }
  return settings;
}

RenderSettings with_time(double seconds, RenderSettings settings) {
  settings.passes = std::numeric_limits<int>::max();
  settings.seconds = seconds;
  settings.denoise_quality = image::OidnQuality::Balanced;
  return settings;
}

RenderSettings with_paths(int spp, RenderSettings settings) {
  settings.passes = (spp + kPathsAPass - 1) / kPathsAPass;
  settings.path_samples = (spp + settings.passes - 1) / settings.passes;
  settings.max_samples = spp;
  return settings;
}

int record_paths(const RenderSettings& settings) {
  const int64_t rays = int64_t{settings.gather_rays} * settings.passes;
  const bool many = std::isinf(settings.seconds) && rays >= kManyRays;
  return (many ? 4 : 1) * render::CacheSettings().paths;
}

}  // namespace lte::infer
