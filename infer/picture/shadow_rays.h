// How many shadow rays each pixel of a picture gets: more where penumbrae are.
//
// A pilot of few rays a pixel knows where light is noisy. If a pixel's own pilot decided, the mean
// of both would be biased: a pilot that misses the light stays alone. So pixels have the colors of
// a checkerboard, and how many rays a pixel gets depends on pilots of the other color alone. They
// are independent of its own, which may then be kept.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "infer/picture/surface_guides.h"
#include "lte/pathtrace/direct_light.h"
#include "lte/pathtrace/lights/lights.h"

namespace lte::infer {

/// Direct light of a pilot, by pixel.
struct Pilot {
  const std::vector<Rgb>& irradiance;  ///< [pixels]
  const std::vector<float>& variance;  ///< [pixels] of the mean of `samples` rays
  int samples = 0;                     ///< rays a pixel
};

/// Further rays by pixel, [pixels].
struct RayCounts {
  std::vector<int32_t> rays;
  /// Variance of one ray's luminance, as the neighbours know it.
  std::vector<float> variance;
};

/// Shares out `mean` further rays a pixel in proportion to the standard error over brightness, as
/// relative MSE weighs it. No pixel gets more than 16 times the mean; background gets none.
/// @param seed  rounds counts up or down
RayCounts share_rays(const SurfaceGuides& guides, const Pilot& pilot, int mean, uint64_t seed);

struct ShadowRays {
  int samples = 64;       ///< a pixel, on average
  bool adaptive = false;  ///< share them out; needs 3 samples at least, fewer are spread evenly
  bool variance = false;  ///< PixelLight::variance is wanted
  uint64_t seed = 0;
};

/// Direct light at the centres of pixels, 0 for background.
struct PixelLight {
  image::Image irradiance;  ///< [height, width, 3]
  /// [height, width, 1]: variance of the mean of luminance, not finite where it is not known.
  image::Image variance;
  int64_t rays = 0;         ///< light samples in all
  int64_t rays_traced = 0;  ///< rays in all
};

/// Direct light of a whole picture. Pixel i draws from stream i.
/// @param check  called between blocks of pixels; what it throws ends it. May be null.
PixelLight light_pixels(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                        const SurfaceGuides& guides, const ShadowRays& wanted,
                        const std::function<void()>& check = {});

}  // namespace lte::infer
