// What a camera's picture is summed up from: light in two independent halves, and what the pixels
// see.
//
// Gathered light is irradiance at the surface that the ray through a pixel's center meets, without
// texture. A pixel at an edge shows several surfaces: it keeps how much of each its rays meet, and
// takes their light from the pixels around whose centers see them. So no pixel's light is a mixture
// before noise is taken out, and rays at edges need no light of their own.
//
// Samples of even passes are the first half, those of odd passes the second. What the halves have
// in common is signal, what they differ by is noise: an error bar, and what pictures are combined
// by (combine.h).
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "lte/image/image.h"
#include "lte/pathtrace/render.h"

namespace lte::render {

/// Light that surfaces reflect, by its bounces; and, of paths alone, what they met at once:
/// radiance towards the camera, or irradiance (Film::gathered). Sums over samples,
/// [height, width, 3]; empty before the first.
struct LightSums {
  image::Image emission, direct, indirect;
  std::vector<int32_t> samples;  ///< [height * width]

  LightSums() = default;
  LightSums(int width, int height);
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
  int64_t samples(size_t pixel) const;
  void forget(size_t pixel);
  /// Standard error of the mean of reflected light over that mean, as the halves tell it, root mean
  /// square over the pixels; infinite without samples in both halves.
  double relative_error() const;
};

/// A pixel and the eight around it.
inline constexpr std::array<std::pair<int, int>, 9> kNearPixels = {
    {{0, 0}, {-1, 0}, {1, 0}, {0, -1}, {0, 1}, {-1, -1}, {1, -1}, {-1, 1}, {1, 1}}};

/// What the camera rays of a pixel at an edge meet. Sums over rays.
struct EdgePixel {
  /// Albedo of hits on the surface that the center of a pixel of kNearPixels sees.
  std::array<Rgb, kNearPixels.size()> albedo;
  Rgb direct, indirect;  ///< radiance of hits that none of them stands for, each lit by itself
  Rgb lit_albedo;        ///< of those hits
  int32_t rays = 0;      ///< of RenderSettings::irradiance: those that meet a surface
  bool mixed = false;    ///< some ray has met something else than the center
};

/// A place on a surface.
struct SurfacePlace {
  Vec3 position, normal;
  float tolerance = 0;  ///< metres that count as none: what a pixel covers there
};

/// Sums of one picture of one camera.
struct Film {
  Film(int width, int height);

  int width, height;
  size_t pixels() const { return surface_hits.size(); }
  size_t number(int x, int y) const {
    return static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x);
  }

  /// By an Integrator: irradiance at the surface of the pixel's center. Where has_metal, radiance
  /// through the whole pixel.
  LightEstimate gathered;
  LightEstimate paths;  ///< radiance through whole pixels: by path tracing alone
  std::vector<EdgePixel> edges;
  std::vector<int32_t> edge_of;  ///< by pixel: its place in `edges` or -1; empty in the first pass

  /// Sums over camera rays, of which surface_hits meet a surface. Albedo, emission and normals are
  /// 0 where rays meet none (emission: the environment's).
  image::Image albedo, normal, emission;
  std::vector<float> depth;  ///< over the rays that meet a surface, along the camera's axis
  image::Image center_position, center_normal;  ///< of the ray through the pixel's center
  std::vector<float> center_tolerance;          ///< SurfacePlace::tolerance
  std::vector<int32_t> rays, surface_hits;
  std::vector<float> metal, default_metal;  ///< empty in a scene without metal
  /// 1: some ray has met metal, so whole-pixel paths stand for `gathered` there; empty as above.
  std::vector<uint8_t> has_metal;

  int passes = 0;       ///< of camera rays
  int path_passes = 0;  ///< of `paths`

  /// Null for pixels that are not at an edge.
  EdgePixel* edge(size_t pixel) {
    return edge_of.empty() || edge_of[pixel] < 0 ? nullptr
                                                 : &edges[static_cast<size_t>(edge_of[pixel])];
  }
  const EdgePixel* edge(size_t pixel) const { return const_cast<Film*>(this)->edge(pixel); }
  /// One of kNearPixels, or kNoPixel outside of the picture.
  size_t near_pixel(size_t pixel, size_t which) const;
  static constexpr size_t kNoPixel = static_cast<size_t>(-1);

  SurfacePlace center(size_t pixel) const {
    return {center_position.rgb(pixel), center_normal.rgb(pixel), center_tolerance[pixel]};
  }
  /// Whether `gathered` has irradiance of the pixel's center, as it has from the first pass on
  /// where that reflects light and is not metal.
  bool is_lit(size_t pixel) const { return !sees_metal(pixel) && gathered.samples(pixel) > 0; }
  bool sees_surface(size_t pixel) const { return surface_hits[pixel] > 0; }
  bool sees_metal(size_t pixel) const { return !has_metal.empty() && has_metal[pixel] != 0; }
  void forget_rays(size_t pixel);
  /// Means over the rays of a pixel.
  image::Image mean(const image::Image& sum) const;
};

/// Bytes a pixel, about, of a film with both estimates.
inline constexpr double kFilmBytes = 254;

}  // namespace lte::render
