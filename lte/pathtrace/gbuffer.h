// What camera rays meet first: G-buffers of whole pictures, of some rows, and of single image
// points.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lte/base/unfilled_vector.h"
#include "lte/pathtrace/bvh.h"

namespace lte::pathtrace {

/// Primary hits, in rows. Normals are of the side that faces the camera: irradiance is that of the
/// visible side. They are shading normals (scene/shading_normal.h).
struct GBuffer {
  int width = 0, height = 0;
  UnfilledVector<Vec3> position, normal;  ///< [height * width]; zero for background
  UnfilledVector<Rgb> albedo;             ///< [height * width]; zero for background
  UnfilledVector<Rgb> emission;  ///< radiance towards the camera, the environment's for background
  UnfilledVector<float> depth;   ///< distance along the camera's axis; INFINITY for background
  UnfilledVector<uint8_t> mask;  ///< 1 where a surface was hit
  UnfilledVector<int32_t> instance;  ///< scene::kNone for background
  /// Empty for a scene without normal maps, whose normals are geometric.
  UnfilledVector<Vec3> geometric_normal;
  /// How metallic the surface is, [0, 1]; empty for a scene without metal.
  UnfilledVector<float> metallic;

  const Vec3& geometric(size_t i) const {
    return geometric_normal.empty() ? normal[i] : geometric_normal[i];
  }
  /// Room for so many hits, of which what is not needed costs no memory.
  void reserve(size_t count);
};

/// Hits through pixel centres. Albedo, emission and metal are filtered over the pixel's footprint.
/// @throws lte::Error if a size is not positive or the camera is degenerate.
GBuffer trace_gbuffer(const Bvh& bvh, const scene::Camera& camera, int width, int height);

/// Rows `first` to `last` − 1 of the same.
GBuffer trace_gbuffer_rows(const Bvh& bvh, const scene::Camera& camera, int width, int height,
                           int first, int last);

/// Rows `first` to `last` − 1 of hits that are there.
GBuffer rows_of(const GBuffer& hits, int first, int last);

/// Hits through any points of a picture of this size, after those of a row that is there or begins
/// empty.
/// @param points  in pixels: (0.5, 0.5) is the centre of the first
/// @param covered  edge in pixels of what albedo, emission and metal are filtered over
void append_image_points(const Bvh& bvh, const scene::Camera& camera, int width, int height,
                         std::span<const Vec2> points, GBuffer* row, float covered = 1);

/// Edge of what a pixel covers at depth 1, in metres.
float pixel_size(const scene::Camera& camera, int height);

/// @throws lte::Error if a size is not positive or the camera is degenerate.
void check_view(const scene::Camera& camera, int width, int height);

}  // namespace lte::pathtrace
