// A picture of gathered light in a given time.
#pragma once

#include <vector>

#include "infer/render/time_budget.h"

namespace lte::infer {

/// What the stages cost, as measured on a small picture.
struct GatherRates {
  double primary_s = 0;  ///< a hit
  double ray_s = 0;      ///< a shadow ray at a pixel
  double gather_s = 0;   ///< a gather ray
  double path_s = 0;     ///< a path of the correction
  double denoise_s = 0;  ///< a pixel of a picture that noise is taken out of, by OidnQuality::Fast
  double finish_s = 0;   ///< a pixel that paths correct: what smoothing the correction takes
  double metal_s = 0;    ///< a pixel, mean over all: paths where metal is
};

/// Predicted seconds of a picture with these settings.
double predicted_gather_seconds(const RenderSettings& settings, const GatherRates& rates);

/// A rung of the ladder that a budget climbs.
struct GatherRung {
  Quality quality = Quality::Draft;
  RenderSettings settings;
};

/// The pictures that a budget may choose, from the quickest to the best: below Draft with fewer
/// rays, up to Final.
std::vector<GatherRung> gather_ladder(Sparse sparse, const GivenFlags& given,
                                      const RenderSettings& base);

/// What a budget has chosen: a rung, and how what is left of the time is spent.
struct GatherChoice {
  GatherRung rung;
  PaceSettings pace;   ///< but for its budget
  bool paced = false;  ///< else all counts are those of the rung
};

/// The best rung that leaves time for what comes after it: Final takes half of `seconds` at most,
/// and the other half is for correcting paths. Below Final rays become more, up to kMostRungRays
/// times, and what is then left are paths.
/// @param spent  seconds that are over already, for the message
/// @throws lte::Error "--time-budget ...: ..." if none is ready in time.
GatherChoice choose_rung(double seconds, double spent, const GatherRates& rates,
                         const std::vector<GatherRung>& ladder, const GivenFlags& given);
inline constexpr double kMostRungRays = 3;

/// plan_picture() for gathered light: the renderer has its table.
/// @param clock  must outlive the plan
PicturePlan plan_gathered(double budget_s, const Timer& clock, Sparse sparse,
                          const GivenFlags& given, const RenderSettings& base,
                          const scene::Camera& camera, Renderer* renderer);

}  // namespace lte::infer
