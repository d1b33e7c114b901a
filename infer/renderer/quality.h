// How many passes, rays and paths a picture has, by its quality, time or number of samples.
#pragma once

#include "infer/renderer/render_settings.h"
#include "lte/base/enum_names.h"

namespace lte::infer {

/// How long a picture takes: passes, and the denoiser's effort.
enum class Quality { Draft, Preview, Final };
constexpr EnumNames<Quality, 3> enum_names(Quality) {
  return {{{Quality::Draft, "draft"}, {Quality::Preview, "preview"}, {Quality::Final, "final"}}};
}

/// The same settings with the passes and the denoiser of a quality, for a picture of their size.
RenderSettings with_quality(Quality quality, RenderSettings settings);
/// The same with passes until a time is over, denoising included.
RenderSettings with_time(double seconds, RenderSettings settings);
/// The same with so many paths a pixel; beyond 256 of them in passes of equally many, but the last.
RenderSettings with_paths(int spp, RenderSettings settings);

/// Paths from each record of the irradiance cache (render::CacheSettings::paths) for such a
/// picture. Where a pixel has so many rays that their noise is small, that of records shows.
int record_paths(const RenderSettings& settings);

}  // namespace lte::infer
