// Reference renderings: pictures by path tracing, of the transport that irradiance has.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "lte/image/image.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/gbuffer.h"
#include "lte/pathtrace/lights/lights.h"

namespace lte::pathtrace {

/// Paths a pixel, in all calls together.
inline constexpr int kMaxPaths = 1 << 30;

struct RenderOptions {
  int spp = 64;       ///< paths a pixel, jittered over it
  int max_depth = 6;  ///< surface hits after the camera: a primary hit whose irradiance has depth 5
  uint64_t seed = 0;
  /// Of calls whose paths go on in one point set a pixel, by the same seed: paths that a pixel has
  /// had, and will have in all; 0: it has those of this call.
  int had = 0, in_all = 0;
};

/// Told of pixels as they are done, by the threads that did them.
using PixelsDone = std::function<void(int64_t pixels)>;

/// The picture by what light did before it reached the camera: left a light that the camera sees,
/// was reflected once, or more often. [height, width, 3] each.
struct RadianceLayers {
  image::Image emission, direct, indirect;
};

/// Radiance towards the camera by path tracing; [height, width, 3]. The result depends neither on
/// threads nor on tiles.
/// @param layers  its parts, whose sum it is; may be null
/// @throws lte::Error if a size or an option is not positive or the camera is degenerate.
image::Image render_reference(const Bvh& bvh, const Lights& lights, const scene::Camera& camera,
                              int width, int height, const RenderOptions& options,
                              const PixelsDone& done = {}, RadianceLayers* layers = nullptr);

/// The parts of a pixel's radiance, as those of RadianceLayers.
struct PixelRadiance {
  Rgb emission, direct, indirect;
};

/// The same for some pixels of the picture: their sums are what render_reference() gives them.
/// @param pixels  y * width + x
std::vector<PixelRadiance> trace_pixels(const Bvh& bvh, const Lights& lights,
                                        const scene::Camera& camera, int width, int height,
                                        std::span<const int64_t> pixels,
                                        const RenderOptions& options, const PixelsDone& done = {});

}  // namespace lte::pathtrace
