// What pixel centres see, as pictures: what denoising and the sharing-out of rays are guided by.
#pragma once

#include <cstdint>
#include <vector>

#include "lte/image/image.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/gbuffer.h"

namespace lte::infer {

/// Pictures of one size, [height, width, 3]; 0 in the background.
struct SurfaceGuides {
  image::Image normal, position, albedo;
  std::vector<uint8_t> mask;   ///< [height * width] 1 where a surface is seen
  std::vector<uint8_t> metal;  ///< likewise, 1 where it is metal
  std::vector<float> depth;    ///< likewise, along the camera's axis; 0 in the background

  int width() const { return normal.width; }
  int height() const { return normal.height; }
  size_t pixels() const { return mask.size(); }
  size_t index(int x, int y) const {
    return static_cast<size_t>(y) * static_cast<size_t>(width()) + static_cast<size_t>(x);
  }
};

/// @throws lte::Error if a size is not positive or the camera is degenerate.
SurfaceGuides trace_guides(const pathtrace::Bvh& bvh, const scene::Camera& camera, int width,
                           int height);

/// The same of hits that are there.
SurfaceGuides guides_of(const pathtrace::GBuffer& hits);

/// Surface points of pixels tile by tile: their rays meet the same nodes and triangles.
struct SurfacePoints {
  std::vector<Vec3> position, normal;
  std::vector<uint64_t> pixel;
};
SurfacePoints points_of(const SurfaceGuides& guides);

}  // namespace lte::infer
