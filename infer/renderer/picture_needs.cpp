#include "infer/renderer/picture_needs.h"

#include <algorithm>

namespace lte::infer {
namespace {

Metal metal_of(const RenderSettings& settings, bool has_light) {
  if (is_geometry(settings.output) || settings.output == Output::Irradiance || !has_light)
    return Metal::Diffuse;
  if (settings.mode == Mode::Neural)
    return settings.metal == Metal::Network ? Metal::Trace : settings.metal;
  return settings.output == Output::Full ? Metal::Diffuse : Metal::Trace;
}

int correction_paths(const RenderSettings& settings, const PictureNeeds& needs) {
  return settings.output == Output::Full && (needs.table || needs.network)
             ? settings.correction_paths
             : 0;
}

bool samples_centres(const RenderSettings& settings, const PictureNeeds& needs) {
  const bool reference = settings.mode == Mode::Reference;
  if (!needs.light || (!reference && !needs.direct && !needs.table)) return false;
  if (settings.pace != nullptr && !needs.table) return false;  // rays are chosen block by block
  return needs.table || (!reference && settings.adaptive_direct) || needs.denoises_sampled;
}

/// All rows where nothing is sampled before the bands, and for a reference that is denoised when
/// it is whole.
int strip_rows(const RenderSettings& settings, const PictureNeeds& needs) {
  if (needs.radiance || (!needs.centres && !needs.corrects_pixels())) return settings.height;
  const int64_t rows = kStripPixels / settings.width / kBandRows * kBandRows;
  return static_cast<int>(std::clamp<int64_t>(rows, kBandRows, settings.height));
}

}  // namespace

bool denoises_sampled(const RenderSettings& settings) {
  const bool few = settings.mode == Mode::Neural && settings.direct_samples <= kDenoiseUpTo;
  return settings.denoise == Denoise::On || (settings.denoise == Denoise::Auto && few);
}

PictureNeeds needs_of(const RenderSettings& settings, bool has_light) {
  const bool neural = settings.mode == Mode::Neural;
  const bool full = settings.output == Output::Full;
  PictureNeeds needs;
  needs.light = has_light && !is_geometry(settings.output);
  needs.indirect = needs.light && settings.output != Output::Direct;
  needs.network = neural && needs.indirect && settings.indirect == Indirect::Decoded;
  needs.table = neural && needs.indirect && settings.indirect == Indirect::Gather;
  needs.direct = neural && (full || settings.output == Output::Direct);
  needs.gathers_direct =
      needs.table && needs.direct && settings.gather.direct && !settings.adaptive_direct;
  needs.keeps_light = needs.table && settings.keep_light && settings.gather.step > 1;
  needs.correction_paths = correction_paths(settings, needs);
  needs.radiance = !neural && full;
  needs.denoises_sampled = denoises_sampled(settings);
  needs.denoises_gathered = settings.denoise != Denoise::Off || settings.gather.denoise;
  needs.metal = metal_of(settings, has_light);
  needs.reflects_by_network = needs.network && settings.metal == Metal::Network;
  needs.centres = samples_centres(settings, needs);
  needs.strip_rows = strip_rows(settings, needs);
  return needs;
}

}  // namespace lte::infer
