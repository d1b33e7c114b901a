// Light at the centres of all pixels of a picture, before anything is composed: where rays are
// shared out over pixels and where noise is taken away. Both look across bands.
//
// Irradiance is denoised, not radiance: it has no texture, and every hit of an anti-aliased pixel
// goes on taking it from a centre on its own surface.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "infer/picture/shadow_rays.h"
#include "infer/picture/surface_guides.h"
#include "infer/renderer/gathered_light.h"
#include "lte/image/denoise.h"

namespace lte::infer {

/// What is wanted at the centres.
struct CentreRequest {
  ShadowRays shadow_rays;  ///< without paths
  bool paths = false;      ///< a reference: direct and indirect light by paths
  bool indirect = false;   ///< of paths
  int path_count = 64, max_depth = 5;
  const image::Denoiser* denoiser = nullptr;              ///< null: noise stays
  image::OidnQuality quality = image::OidnQuality::High;  ///< of direct light's
  /// Without paths: what indirect light is gathered from, and with how many rays; null: none is.
  const gi::RadiosityTable* table = nullptr;
  GatherSettings gather;
  int correction_paths = 0;  ///< from each centre, that correct what is gathered
  /// With gather.direct: direct and indirect light in one picture, CentreLight::total.
  bool sum = false;
  KeptViews* kept = nullptr;             ///< of what is gathered; null: pictures share nothing
  std::optional<Projection> projection;  ///< of the picture, with `kept`
  int first_row = 0;                     ///< of the picture, that of the hits
  float pixel_size = 0;                  ///< pathtrace::pixel_size()
  bool skip_metal = false;               ///< of what is gathered
  const image::Denoiser* gather_denoiser = nullptr;  ///< null: noise stays
  bool direct = true;                                ///< wanted
  std::function<void(int64_t pixels)> done;  ///< told of all pixels of the picture; may be empty
};

/// Irradiance, [height, width, 3], 0 in the background; empty where it is not wanted.
struct CentreLight {
  image::Image direct, indirect, total;
  int64_t gathered = 0;  ///< pixels that rays were gathered at
  double sampling_seconds = 0, denoising_seconds = 0, gathering_seconds = 0, path_seconds = 0;
};

/// @param hits  at the centres
CentreLight light_centres(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                          const pathtrace::GBuffer& hits, const CentreRequest& request);

}  // namespace lte::infer
