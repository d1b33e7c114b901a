// A picture in a given time: what the stages cost is measured on a small one first.
#pragma once

#include <memory>
#include <optional>

#include "infer/picture/ray_pace.h"
#include "infer/render/quality.h"
#include "infer/renderer/renderer.h"
#include "lte/base/timer.h"

namespace lte::infer {

/// The switches of a picture, and what a time budget measures while it is made.
struct PicturePlan {
  Quality quality = Quality::Final;
  RenderSettings settings;
  std::unique_ptr<RayPace> pace;  ///< settings.pace; none without a budget or with rays by hand
  std::unique_ptr<PicturePace> gather_pace;  ///< settings.gather.pace, of gathered light
};

/// The settings of `quality`, but for those of `base` that the user has given.
RenderSettings with_quality(Quality quality, Sparse sparse, const GivenFlags& given,
                            RenderSettings base);

/// The picture that rates are measured on: the view, but of about `pixels` pixels at most and
/// without any skip, layers or pace, and without the light of others.
RenderSettings probe_settings(const RenderSettings& base, double pixels, int direct_samples);

/// Chooses the best quality that is ready when `clock` says `budget_s`.
/// @param renderer  has its embedding, if the output needs one
/// @param base      the settings as the flags have them
/// @param clock     runs since the work that counts has begun
/// @throws lte::Error of one line if no picture can be ready in time.
PicturePlan plan_picture(double budget_s, const Timer& clock, Sparse sparse,
                         const GivenFlags& given, const RenderSettings& base,
                         const scene::Camera& camera, Renderer* renderer);

/// @throws lte::Error if the budget is spent already, by what comes before the first picture.
void check_time_left(double budget_s, double spent_s);

}  // namespace lte::infer
