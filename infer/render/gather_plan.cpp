#include "infer/render/gather_plan.h"

#include <algorithm>
#include <cmath>

#include "lte/base/check.h"

namespace lte::infer {
namespace {

/// Pixels of the picture that rates are measured on, and its rays.
constexpr double kRatePixels = 3072;
constexpr int kRateRays = 4;
/// Shares of the pixels that lie at edges, and that no pixel of a sparse grid stands for.
constexpr double kEdges = 0.3, kAlone = 0.03;
/// Passes of the quickest denoiser that a correction by paths takes as long as.
constexpr double kCorrectionPasses = 4;
/// A budget beyond Final doubles its gather rays up to so many, and then buys paths.
constexpr int kMostRays = 128;
/// Room for what predictions leave out.
constexpr double kRoom = 0.2;
/// Paths a pixel of Final at most.
constexpr int kMostPaths = 1 << 14;

/// Time of a pass against the quickest (docs/lab/gather.md).
double denoiser_factor(image::OidnQuality quality) {
  switch (quality) {
    case image::OidnQuality::Fast:
      return 1;
    case image::OidnQuality::Balanced:
      return 2;
    default:
      return 4;
  }
}

GatherRates measure_gather_rates(const RenderSettings& base, const scene::Camera& camera,
                                 Renderer* renderer) {
  RenderSettings probe = probe_settings(base, kRatePixels, kRateRays);
  probe.gather = {kRateRays, 1, 0, image::OidnQuality::Fast};
  renderer->render(camera, probe);  // the denoiser's library is loaded once
  const Frame frame = renderer->render(camera, probe);
  const StageSeconds seconds = renderer->seconds();
  const double hits = double{1} * probe.width * probe.height;
  const double rays = kRateRays * static_cast<double>(std::max<int64_t>(1, frame.decoded));
  GatherRates rates;
  rates.primary_s = seconds.primary / hits;
  rates.metal_s = seconds.reference / hits;
  rates.ray_s = seconds.direct / rays;
  rates.gather_s = seconds.gather / rays;
  rates.denoise_s = seconds.denoise / (2 * hits);
  probe.gather.paths = 2;
  renderer->render(camera, probe);
  const double paths = renderer->seconds().reference - seconds.reference;
  rates.path_s = std::max(rates.gather_s, 2 * paths / rays);
  return rates;
}

}  // namespace

double predicted_gather_seconds(const RenderSettings& settings, const GatherRates& rates) {
  const double pixels = double{1} * settings.width * settings.height;
  const double hits = 1 + kEdges * settings.antialias;
  const double step = settings.gather.step;
  const double points = step > 1 ? 1 / (step * step) : 1;
  const auto rays_of = [&](int rays) {
    return points * rays + (step > 1 ? kAlone * std::max(rays, kLeastAloneRays) : 0);
  };
  const bool few_direct = settings.gather.direct && step > 1;
  const double shadow_rays =
      few_direct ? rays_of(settings.direct_samples) : double{1} * settings.direct_samples;
  double passes = points;
  if (few_direct) {
    passes += settings.layers ? points : 0;
  } else if (denoises_sampled(settings)) {
    passes += 1;
  }
  if (settings.denoise == Denoise::Off) passes = 0;
  const double corrected = settings.gather.paths > 0 ? kCorrectionPasses : 0;
  return pixels * (1 + kRoom) *
         (rates.primary_s * hits + rates.metal_s + rates.ray_s * shadow_rays +
          rates.gather_s * rays_of(settings.gather.rays) + rates.path_s * settings.gather.paths +
          rates.denoise_s * (passes * denoiser_factor(settings.gather.quality) + corrected));
}

std::vector<GatherRung> gather_ladder(Sparse sparse, const GivenFlags& given,
                                      const RenderSettings& base) {
  std::vector<GatherRung> out;
  for (const Quality quality : {Quality::Draft, Quality::Preview, Quality::Final})
    out.push_back({quality, with_quality(quality, sparse, given, base)});
  const RenderSettings draft = out.front().settings;
  RenderSettings least = draft;
  if (!given.direct_samples) least.direct_samples = 4;
  if (!given.antialias) least.antialias = 4;
  if (!given.gather_rays) least.gather.rays = 4;
  if (!given.sparse) least.gather.step = 4;
  out.insert(out.begin(), {Quality::Draft, least});
  return out;
}

GatherRung choose_rung(double seconds, double spent, const GatherRates& rates,
                       const std::vector<GatherRung>& ladder, const GivenFlags& given) {
  const double need = predicted_gather_seconds(ladder.front().settings, rates);
  LTE_CHECK(need <= seconds, "--time-budget: ", seconds_text(std::max(0.0, seconds)),
            " are left after ", seconds_text(spent),
            " for the table of light, and the quickest picture takes about ", seconds_text(need),
            ": expected ", seconds_text(spent + need), " or more");
  GatherRung best = ladder.front();
  for (const GatherRung& rung : ladder) {
    if (predicted_gather_seconds(rung.settings, rates) <= seconds) best = rung;
  }
  if (best.quality != Quality::Final) return best;
  while (!given.gather_rays && 2 * best.settings.gather.rays <= kMostRays) {
    RenderSettings more = best.settings;
    more.gather.rays *= 2;
    if (predicted_gather_seconds(more, rates) > seconds) break;
    best.settings = more;
  }
  if (given.correction_paths) return best;
  const double pixels = double{1} * best.settings.width * best.settings.height;
  const double left = seconds - predicted_gather_seconds(best.settings, rates);
  const double paths = left / (pixels * (1 + kRoom) * std::max(rates.path_s, 1e-12));
  best.settings.gather.paths += 2 * static_cast<int>(std::min(paths, double{kMostPaths}) / 2);
  return best;
}

PicturePlan plan_gathered(double budget_s, const Timer& clock, Sparse sparse,
                          const GivenFlags& given, const RenderSettings& base,
                          const scene::Camera& camera, Renderer* renderer) {
  const double spent = clock.seconds();
  LTE_CHECK(spent < budget_s, "--time-budget ", budget_s, "s: the table of light took ",
            static_cast<int>(std::ceil(1000 * spent)),
            " ms: expected more than that, or fewer --table-points");
  const GatherRates rates = measure_gather_rates(base, camera, renderer);
  const GatherRung rung = choose_rung(budget_s - clock.seconds(), spent, rates,
                                      gather_ladder(sparse, given, base), given);
  return {rung.quality, rung.settings, nullptr};
}

}  // namespace lte::infer
