// What a camera's picture is summed up from: light in two independent halves, and what the pixels
// see.
//
// Samples of even passes are the first half, those of odd passes the second. What the halves have
// in common is signal, what they differ by is noise: an error bar, and what pictures are combined
// by (combine.h).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lte/image/image.h"
#include "lte/pathtrace/render.h"

namespace lte::render {

/// Radiance towards the camera that surfaces reflect, by the bounces of its light; and, of paths
/// alone, what they met at once. Sums over samples, [height, width, 3]; empty before the first.
struct LightSums {
  image::Image emission, direct, indirect;
  std::vector<int32_t> samples;  ///< [height * width]

  bool empty() const { return samples.empty(); }
  void add(size_t pixel, const pathtrace::PixelRadiance& sum, int32_t count);
};

/// Light by one estimator.
struct LightEstimate {
  std::array<LightSums, 2> halves;

  bool empty() const { return halves[0].empty() && halves[1].empty(); }
  /// Means over the samples of both halves; 0 where there are none. Empty without any samples.
  pathtrace::RadianceLayers mean() const;
  /// The mean of one half; the other's in pixels that it has no samples in.
  pathtrace::RadianceLayers mean_of(size_t half) const;
  void forget(size_t pixel);
  /// Standard error of the mean of reflected light over that mean, as the halves tell it, root mean
  /// square over the pixels; infinite without samples in both halves.
  double relative_error() const;
};

/// Sums of one picture of one camera.
struct Film {
  Film(int width, int height);

  int width, height;
  size_t pixels() const { return surface_hits.size(); }
  size_t number(int x, int y) const {
    return static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x);
  }

  LightEstimate gathered;  ///< at points that the camera sees: by an Integrator
  LightEstimate paths;     ///< through whole pixels: by path tracing alone
  /// [height, width, 3]: of the albedo of the points of `gathered`, whose texture its light has.
  image::Image gathered_albedo;

  /// Sums over camera rays, of which surface_hits meet a surface. Albedo, emission and normals are
  /// 0 where rays meet none (emission: the environment's).
  image::Image albedo, normal, emission;
  image::Image position;     ///< over the rays that meet a surface, world
  std::vector<float> depth;  ///< likewise, along the camera's axis
  std::vector<int32_t> rays, surface_hits;
  std::vector<float> metal, default_metal;  ///< empty in a scene without metal
  /// 1: some ray has met metal, so whole-pixel paths stand for `gathered` there; empty as above.
  std::vector<uint8_t> has_metal;

  int passes = 0;       ///< of camera rays
  int path_passes = 0;  ///< of `paths`

  bool sees_surface(size_t pixel) const { return surface_hits[pixel] > 0; }
  bool sees_metal(size_t pixel) const { return !has_metal.empty() && has_metal[pixel] != 0; }
  /// Means over the rays of a pixel.
  image::Image mean(const image::Image& sum) const;
};

/// Bytes a pixel, about, of a film with both estimates.
inline constexpr double kFilmBytes = 220;

}  // namespace lte::render
