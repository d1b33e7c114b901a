// Indirect light at the centres of all pixels by final gather, without its noise, and corrected by
// paths where they say better.
#pragma once

#include <cstdint>

#include "infer/picture/surface_guides.h"
#include "lte/gi/radiosity_table.h"
#include "lte/image/denoise.h"
#include "lte/pathtrace/lights.h"

namespace lte::infer {

struct GatherSettings {
  int rays = 16;  ///< a point
  /// Points at every so many columns and rows: a power of two. Pixels in between take their light
  /// from those on their surface, and have rays of their own where there are none.
  int step = 1;
  /// Paths a pixel that correct the answer (path_correction.h); an even number, 0 for none.
  int paths = 0;
  image::OidnQuality quality = image::OidnQuality::High;  ///< of the denoiser
};

/// @throws lte::Error naming what is out of range.
void check_gather_settings(const GatherSettings& settings);

/// What is gathered from.
struct GatherScene {
  const pathtrace::Bvh& bvh;
  const pathtrace::Lights& lights;
  const gi::RadiosityTable& table;
  int max_depth = 5;  ///< of the picture: surface hits after the primary one
  uint64_t seed = 0;
};

/// Rays, at least, where nothing smooths them: in pixels that stand alone.
inline constexpr int kLeastAloneRays = 16;

/// Indirect irradiance at points by themselves.
/// @param first_index  numbers the streams of their rays
std::vector<Rgb> gather_points(const GatherScene& scene, std::span<const Vec3> positions,
                               std::span<const Vec3> normals, int rays, int64_t first_index);

struct GatheredCentres {
  image::Image irradiance;  ///< [height, width, 3]; 0 where no light is reflected
  int64_t gathered = 0;     ///< pixels that had rays
  double gather_seconds = 0, path_seconds = 0, denoise_seconds = 0;
};

/// @param pixel_size  pathtrace::pixel_size()
/// @param skip_metal  metal is left out: others show it
/// @param denoiser    null: noise stays
GatheredCentres gather_centres(const GatherScene& scene, const SurfaceGuides& guides,
                               float pixel_size, bool skip_metal, const GatherSettings& settings,
                               const image::Denoiser* denoiser);

}  // namespace lte::infer
