// Images: primary hits, and reference renderings of the same transport.
#pragma once

#include <cstdint>
#include <vector>

#include "lte/image/image.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/lights.h"

namespace lte::pathtrace {

/// Primary hits through pixel centres. Normals face the camera: irradiance is that of the visible
/// side.
struct GBuffer {
  int width = 0, height = 0;
  std::vector<Vec3> position, normal;  ///< [height * width]
  std::vector<Rgb> albedo;             ///< [height * width]
  std::vector<Rgb> emission;  ///< radiance towards the camera, the environment's for background
  std::vector<float> depth;   ///< distance along the camera's axis; INFINITY for background
  std::vector<uint8_t> mask;  ///< 1 where a surface was hit
};

/// Albedo and emission are filtered over the pixel's footprint.
/// @throws lte::Error if a size is not positive or the camera is degenerate.
GBuffer trace_gbuffer(const Bvh& bvh, const scene::Camera& camera, int width, int height);

struct RenderOptions {
  int spp = 64;       ///< paths a pixel, jittered over it
  int max_depth = 6;  ///< surface hits after the camera: a primary hit whose irradiance has depth 5
  uint64_t seed = 0;
};

/// Radiance towards the camera by path tracing; [height, width, 3]. The result depends neither on
/// threads nor on tiles.
/// @throws lte::Error if a size or an option is not positive or the camera is degenerate.
image::Image render_reference(const Bvh& bvh, const Lights& lights, const scene::Camera& camera,
                              int width, int height, const RenderOptions& options);

}  // namespace lte::pathtrace
