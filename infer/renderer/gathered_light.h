// Light at the centres of all pixels by final gather, without its noise, and corrected by paths
// where they say better; direct light too, where a picture samples it as sparsely.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "infer/picture/projection.h"
#include "infer/renderer/kept_views.h"
#include "infer/renderer/picture_pace.h"
#include "infer/renderer/point_light.h"
#include "lte/image/denoise.h"
#include "lte/pathtrace/gbuffer.h"

namespace lte::infer {

struct GatherSettings {
  int rays = 16;  ///< a point
  /// Points at every so many columns and rows: a power of two. Pixels in between take their light
  /// from those on their surface, and have rays of their own where there are none.
  int step = 1;
  image::OidnQuality quality = image::OidnQuality::High;  ///< of the denoiser
  /// Direct light is sampled at these points alone, too.
  bool direct = false;
  /// Chooses the rays near `rays`, and in a full picture the paths. May be null.
  PicturePace* pace = nullptr;
  /// Called between blocks of points, by the thread that gathers; what it throws ends the picture.
  /// May be null.
  std::function<void()> check = {};
  /// Take its noise away even where RenderSettings::denoise is off.
  bool denoise = false;
};

/// @throws lte::Error naming what is out of range.
void check_gather_settings(const GatherSettings& settings);

/// Rays, at least, of pixels that stand alone, where no denoiser takes their noise away.
inline constexpr int kLeastAloneRays = 8;

/// What is wanted beside indirect light.
struct GatherDirect {
  int shadow_rays = 0;  ///< a point; 0: no direct light
  bool sum = false;     ///< one picture of both, whose noise is taken away at once
};

/// Rows of a picture whose light is gathered.
struct GatherRows {
  const pathtrace::GBuffer& hits;  ///< at the centres
  float pixel_size = 0;            ///< pathtrace::pixel_size()
  bool skip_metal = false;         ///< metal is left out: others show it
  /// Light that earlier pictures have found is taken from here, and what is found is added; null
  /// for neither.
  KeptViews* kept = nullptr;
  std::optional<Projection> projection;  ///< of the whole picture, with `kept`
  int first_row = 0;                     ///< of the picture, that of the hits
};

/// Pictures [height, width, 3], 0 where no light is reflected; empty where they are not wanted.
struct GatheredCentres {
  image::Image indirect, direct, total;
  LightWork work;
  double path_seconds = 0, denoise_seconds = 0, fill_seconds = 0;
};

/// @param correction_paths  from each pixel's centre that correct indirect light; an even number, 0
///                          for none
/// @param denoiser          null: noise stays
GatheredCentres gather_centres(const GatherScene& scene, const GatherRows& rows,
                               const GatherSettings& settings, const GatherDirect& direct,
                               int correction_paths, const image::Denoiser* denoiser);

}  // namespace lte::infer
