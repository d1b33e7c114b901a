#include "infer/render/gather_plan.h"

#include <algorithm>
#include <cmath>

#include "lte/base/check.h"

namespace lte::infer {
namespace {

/// Pixels of the picture that rates are measured on: so many a second of the budget, between these
/// bounds. Smaller ones are slower by the pixel.
constexpr double kRatePixels = 6144, kLeastRatePixels = 1536;
constexpr int kRateRays = 8;
/// Share of the pixels that lie at edges, and what a hit there costs beside one at a centre.
constexpr double kEdges = 0.25, kEdgeHit = 0.35;
/// Share of the pixels that no pixel of a sparse grid stands for and that have rays of their own.
constexpr double kAlone = 0.008;
/// Filling the pixels between those of a grid, in passes of the quickest denoiser.
constexpr double kFill = 0.4;
/// Where no paths follow, a budget beyond Final doubles its gather rays up to so many, while the
/// picture takes no more than this share of the time.
constexpr int kMostRays = 128;
constexpr double kMostRaysShare = 0.35;
/// Room for what predictions leave out.
constexpr double kRoom = 0.05;
/// Share of the time that a picture takes before its paths where it is less, by more rays.
constexpr double kBaseShare = 0.6;
/// Paths that pixels at edges have in either half before others have any.
constexpr int kRoughFirst = 16;
/// Over what the probe's correction takes by pixel: a whole picture's takes more.
constexpr double kFinishRoom = 1.2;
/// What a picture before its paths may take beyond its prediction until its rays become fewer.
constexpr double kBaseRoom = 1.25;
/// The fewest rays of a machine that has become slow, as a share of the wanted ones.
constexpr double kLeastRays = 0.25;
/// Paths a pixel of Final at most, where they are chosen ahead.
constexpr int kMostPaths = 1 << 14;

/// Time of a pass against the quickest (docs/lab/gather.md).
double denoiser_factor(image::OidnQuality quality) {
  switch (quality) {
    case image::OidnQuality::Fast:
      return 1;
    case image::OidnQuality::Balanced:
      return 2;
    default:
      return 3.5;
  }
}

double pixels_of(const RenderSettings& settings) {
  return double{1} * settings.width * settings.height;
}

/// The picture without its paths.
RenderSettings base_of(RenderSettings settings) {
  settings.correction_paths = 0;
  return settings;
}

GatherRates measure_gather_rates(const RenderSettings& base, double pixels,
                                 const scene::Camera& camera, Renderer* renderer) {
  RenderSettings probe = probe_settings(base, pixels, kRateRays);
  probe.gather = {kRateRays, 1, image::OidnQuality::Fast};
  probe.correction_paths = 0;
  renderer->render(camera, probe);  // the denoiser's library is loaded once
  const Frame frame = renderer->render(camera, probe);
  const StageSeconds seconds = renderer->seconds();
  const double hits = pixels_of(probe);
  const double rays = kRateRays * static_cast<double>(std::max<int64_t>(1, frame.decoded));
  GatherRates rates;
  rates.primary_s = seconds.primary / hits;
  rates.metal_s = seconds.reference / hits;
  rates.ray_s = seconds.direct / rays;
  rates.gather_s = seconds.gather / rays;
  rates.denoise_s = seconds.denoise / (2 * hits);
  probe.correction_paths = 2;
  // The denoiser of paths is set up once, too. Quicker pictures have no time for any.
  if (pixels >= kRatePixels) renderer->render(camera, probe);
  renderer->render(camera, probe);
  const StageSeconds& corrected = renderer->seconds();
  rates.path_s = std::max(rates.gather_s, (corrected.reference - seconds.reference) / (2 * hits));
  rates.finish_s = std::max(0.0, corrected.denoise - seconds.denoise) / hits;
  return rates;
}

/// Predicted seconds of a picture before its paths, by when they are spent.
struct BaseSeconds {
  double before = 0;  ///< first hits, metal, and direct light where it is sampled at every pixel
  double rays = 0;    ///< at the points of the grid: what a pace may change
  double after = 0;   ///< denoising, pixels between points, hits at edges
  double sum() const { return before + rays + after; }
};

BaseSeconds base_seconds(const RenderSettings& settings, const GatherRates& rates) {
  const double pixels = pixels_of(settings) * (1 + kRoom);
  const double step = settings.gather.step;
  const double points = 1 / (step * step);
  const bool few_direct = settings.gather.direct && step > 1;
  const double sampled_passes = !few_direct && denoises_sampled(settings) ? 1 : 0;
  const double gathered_passes = few_direct && settings.layers ? 2 * points : points;
  const double pass = settings.denoise == Denoise::Off
                          ? 0
                          : rates.denoise_s * denoiser_factor(settings.gather.quality);
  const auto point = [&](int gather, int shadow) {
    return rates.gather_s * gather + (few_direct ? rates.ray_s * shadow : 0);
  };
  BaseSeconds out;
  out.before = pixels * (rates.primary_s + rates.metal_s + pass * sampled_passes +
                         (few_direct ? 0 : rates.ray_s * settings.direct_samples));
  out.rays = pixels * points * point(settings.gather.rays, settings.direct_samples);
  out.after = pixels * (rates.primary_s * kEdges * kEdgeHit * settings.antialias +
                        kAlone * point(std::max(settings.gather.rays, kLeastAloneRays),
                                       std::max(settings.direct_samples, kLeastAloneRays)) +
                        pass * gathered_passes + (step > 1 ? kFill * rates.denoise_s : 0));
  return out;
}

/// Spends what a picture of gathered light leaves of the time, where paths are not counted by hand.
void choose_pace(double seconds, const GatherRates& rates, const GivenFlags& given,
                 GatherChoice* choice) {
  RenderSettings& settings = choice->rung.settings;
  const double pixels = pixels_of(settings);
  const BaseSeconds base = base_seconds(settings, rates);
  const bool by_hand = given.gather_rays || given.direct_samples;
  // When the base is to be ready: rays become more where that is later than predicted.
  double base_end = kBaseRoom * base.sum();
  if (!by_hand)
    base_end = std::min(base.sum() + (kMostRungRays - 1) * base.rays, kBaseShare * seconds);
  base_end = std::max(base_end, base.sum());
  // Two paths in both halves of each pixel at an edge are the least that help.
  const double least_paths =
      pixels * (4 * kEdges * rates.path_s + PicturePace::kRoughFinish * rates.finish_s);
  // Where the base turns out slower than predicted, the pace has none.
  const bool paths = base.sum() + least_paths <= seconds;
  if (paths) base_end = std::min(base_end, seconds - least_paths);
  PaceSettings& pace = choice->pace;
  pace.paths = paths;
  pace.rough_first = kRoughFirst;
  pace.base_s = (paths ? base_end : seconds) / pixels;
  pace.after_rays_s = base.after / pixels;
  pace.gather_s = rates.gather_s;
  pace.shadow_s = rates.ray_s;
  pace.path_s = rates.path_s;
  pace.finish_s = kFinishRoom * rates.finish_s;
  pace.least = by_hand ? 1 : kLeastRays;
  pace.most = by_hand ? 1 : kMostRungRays;
  choice->paced = true;
  settings.correction_paths = paths ? std::max(2, settings.correction_paths) : 0;
}

/// The same where all counts are chosen ahead: of irradiance alone.
void count_paths(double seconds, const GatherRates& rates, RenderSettings* settings) {
  const double left = seconds - predicted_gather_seconds(*settings, rates);
  const double paths = left / (pixels_of(*settings) * (1 + kRoom) * std::max(rates.path_s, 1e-12));
  settings->correction_paths +=
      2 * static_cast<int>(std::clamp(paths, 0.0, double{kMostPaths}) / 2);
}

}  // namespace

double predicted_gather_seconds(const RenderSettings& settings, const GatherRates& rates) {
  const int paths = settings.correction_paths;
  return base_seconds(settings, rates).sum() +
         pixels_of(settings) * (1 + kRoom) *
             (rates.path_s * paths + (paths > 0 ? rates.finish_s : 0));
}

std::vector<GatherRung> gather_ladder(Sparse sparse, const GivenFlags& given,
                                      const RenderSettings& base) {
  std::vector<GatherRung> out;
  for (const Quality quality : {Quality::Draft, Quality::Preview, Quality::Final})
    out.push_back({quality, with_quality(quality, sparse, given, base)});
  const RenderSettings draft = out.front().settings;
  const auto quicker = [&](int rays, int step, int antialias) {
    RenderSettings least = draft;
    if (!given.direct_samples) least.direct_samples = rays;
    if (!given.antialias) least.antialias = antialias;
    if (!given.gather_rays) least.gather.rays = rays;
    if (!given.sparse) least.gather.step = std::max(step, least.gather.step);
    return GatherRung{Quality::Draft, least};
  };
  out.insert(out.begin(), {quicker(4, 8, 0), quicker(4, 4, 4)});
  return out;
}

GatherChoice choose_rung(double seconds, double spent, const GatherRates& rates,
                         const std::vector<GatherRung>& ladder, const GivenFlags& given) {
  const double need = predicted_gather_seconds(base_of(ladder.front().settings), rates);
  LTE_CHECK(need <= seconds, "--time-budget: ", seconds_text(std::max(0.0, seconds)),
            " are left after ", seconds_text(spent),
            " for the table of light, and the quickest picture takes about ", seconds_text(need),
            ": expected ", seconds_text(spent + need), " or more");
  const bool full = ladder.front().settings.output == Output::Full;
  GatherChoice choice{ladder.front(), {}, false};
  const bool paced = full && !given.correction_paths;
  for (const GatherRung& rung : ladder) {
    // What time there is beyond Preview is better spent on paths than on Final's rays.
    if (paced && rung.quality == Quality::Final) continue;
    const RenderSettings settings = paced ? base_of(rung.settings) : rung.settings;
    if (predicted_gather_seconds(settings, rates) <= seconds) choice.rung = rung;
  }
  RenderSettings& best = choice.rung.settings;
  if (choice.rung.quality == Quality::Final) {
    while (!given.gather_rays && 2 * best.gather.rays <= kMostRays) {
      RenderSettings more = best;
      more.gather.rays *= 2;
      if (predicted_gather_seconds(base_of(more), rates) > kMostRaysShare * seconds) break;
      best = more;
    }
  }
  if (paced) {
    choose_pace(seconds, rates, given, &choice);
  } else if (choice.rung.quality == Quality::Final && !given.correction_paths) {
    count_paths(seconds, rates, &best);
  }
  return choice;
}

PicturePlan plan_gathered(double budget_s, const Timer& clock, Sparse sparse,
                          const GivenFlags& given, const RenderSettings& base,
                          const scene::Camera& camera, Renderer* renderer) {
  const double spent = clock.seconds();
  LTE_CHECK(spent < budget_s, "--time-budget ", budget_s, "s: the table of light took ",
            static_cast<int>(std::ceil(1000 * spent)),
            " ms: expected more than that, or fewer --table-points");
  const double pixels = std::clamp(kRatePixels * budget_s, kLeastRatePixels, kRatePixels);
  const GatherRates rates = measure_gather_rates(base, pixels, camera, renderer);
  GatherChoice choice = choose_rung(budget_s - clock.seconds(), spent, rates,
                                    gather_ladder(sparse, given, base), given);
  PicturePlan plan{choice.rung.quality, choice.rung.settings, nullptr, nullptr};
  if (!choice.paced) return plan;
  choice.pace.budget_s = budget_s;
  plan.gather_pace =
      std::make_unique<PicturePace>(choice.pace, [&clock] { return clock.seconds(); });
  plan.settings.gather.pace = plan.gather_pace.get();
  return plan;
}

}  // namespace lte::infer
