#include "infer/render/time_budget.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lte/base/check.h"

namespace lte::infer {
namespace {

/// Pixels of the picture that rates are measured on, and its shadow rays.
constexpr double kProbePixels = 1536;
constexpr int kProbeRays = 8;
/// A budget that suffices for more than Final takes so many times its shadow rays.
constexpr int kMostOfFinal = 4;

/// Renders the view small and without any skip.
PictureRates measure_rates(const RenderSettings& base, const scene::Camera& camera,
                           Renderer* renderer) {
  const RenderSettings probe = probe_settings(base, kProbePixels, kProbeRays);
  const Frame frame = renderer->render(camera, probe);
  const StageSeconds& seconds = renderer->seconds();
  const double hits = double{1} * probe.width * probe.height;
  PictureRates rates;
  rates.primary_s = seconds.primary / hits;
  rates.metal_s = seconds.reference / hits;
  if (frame.queries == 0) return rates;
  const auto queries = static_cast<double>(frame.queries);
  rates.decode_s = seconds.decode / queries;
  rates.ray_s = seconds.direct / (queries * kProbeRays);
  return rates;
}

}  // namespace

RenderSettings probe_settings(const RenderSettings& base, double pixels, int direct_samples) {
  RenderSettings probe = base;
  const double scale = std::min(1.0, std::sqrt(pixels / (double{1} * base.width * base.height)));
  probe.width = std::max(1, static_cast<int>(base.width * scale));
  probe.height = std::max(1, static_cast<int>(base.height * scale));
  probe.direct_samples = direct_samples;
  probe.antialias = 0;
  probe.sparse.reset();
  probe.layers = false;
  probe.pace = nullptr;
  probe.keep_light = false;
  probe.done = {};
  return probe;
}

RenderSettings with_quality(Quality quality, Sparse sparse, const GivenFlags& given,
                            RenderSettings base) {
  const QualitySettings chosen = quality_settings(quality);
  const bool gathers = base.indirect == Indirect::Gather;
  if (!given.direct_samples) {
    base.direct_samples = gathers ? chosen.gather_direct_samples : chosen.direct_samples;
    base.gather.direct = chosen.gather.direct;
  }
  if (!given.antialias) base.antialias = gathers ? chosen.gather_antialias : chosen.antialias;
  base.gather.quality = chosen.gather.quality;
  if (!given.gather_rays) base.gather.rays = chosen.gather.rays;
  if (!given.correction_paths) base.correction_paths = gathers ? chosen.correction_paths : 0;
  base.sparse.reset();
  base.gather.step = 1;
  const bool on = sparse == Sparse::On || (sparse == Sparse::Auto && chosen.sparse);
  if (!on || base.mode != Mode::Neural) return base;
  if (gathers) {
    const bool large = int64_t{base.width} * base.height > kLargePicture;
    base.gather.step = large ? chosen.large_step : chosen.gather.step;
    if (large && chosen.large_rays > 0) {
      if (!given.gather_rays) base.gather.rays = chosen.large_rays;
      if (!given.direct_samples) base.direct_samples = chosen.large_rays;
    }
  } else {
    base.sparse = chosen.answers;
  }
  return base;
}

void check_time_left(double budget_s, double spent_s) {
  LTE_CHECK(spent_s < budget_s, "--time-budget ", budget_s, "s: scene points and encoding took ",
            static_cast<int>(std::ceil(1000 * spent_s)),
            " ms: expected more than that, or fewer --scene-points");
}

PicturePlan plan_picture(double budget_s, const Timer& clock, Sparse sparse,
                         const GivenFlags& given, const RenderSettings& base,
                         const scene::Camera& camera, Renderer* renderer) {
  const double spent = clock.seconds();
  check_time_left(budget_s, spent);
  const PictureRates rates = measure_rates(base, camera, renderer);
  std::array<QualitySettings, 3> settings;
  for (const Quality quality : {Quality::Draft, Quality::Preview, Quality::Final}) {
    const RenderSettings with = with_quality(quality, sparse, given, base);
    QualitySettings& entry = settings[static_cast<size_t>(quality)];
    entry = quality_settings(quality);
    entry.direct_samples = with.direct_samples;
    entry.antialias = with.antialias;
    entry.sparse = with.sparse.has_value();
  }
  PicturePlan plan;
  plan.quality = choose_quality(budget_s - clock.seconds(), spent, rates,
                                int64_t{base.width} * base.height, settings, given.direct_samples);
  plan.settings = with_quality(plan.quality, sparse, given, base);
  if (!given.direct_samples) {
    const int most = kMostOfFinal * quality_settings(Quality::Final).direct_samples;
    plan.pace = std::make_unique<RayPace>(budget_s, rates.ray_s, most,
                                          [&clock] { return clock.seconds(); });
    plan.settings.pace = plan.pace.get();
    if (plan.settings.sparse)
      plan.settings.sparse->stop = [pace = plan.pace.get()] { return pace->late(); };
  }
  return plan;
}

}  // namespace lte::infer
