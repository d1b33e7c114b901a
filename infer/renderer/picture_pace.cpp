#include "infer/renderer/picture_pace.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace lte::infer {
namespace {

/// Paths in rough pixels for one in smooth ones: most of a picture's error is at edges.
constexpr int kRoughPaths = 5;
/// Smooth pixels begin with so many, in either half: fewer tell a denoiser too little. It is a pass
/// of its own, as their paths may take longer than those at edges did.
constexpr int kSmoothFirst = 5;
/// Shares of the time left that a pass is to take where it can be smaller, and where it is the
/// least there is.
constexpr double kShare = 0.5, kLast = 0.9;
/// What is kept back for writing and for what is not timed, as a share of the budget.
constexpr double kKept = 0.01;
/// Paths a pixel at most, in either half: beyond, a float holds no more of their sum.
constexpr int kMostPaths = 1 << 14;

}  // namespace

PicturePace::PicturePace(const PaceSettings& settings, std::function<double()> clock)
    : settings_(settings),
      clock_(std::move(clock)),
      gather_rate_(settings.gather_s),
      shadow_rate_(settings.shadow_s),
      path_rate_(settings.path_s) {}

void PicturePace::begin_rows(int64_t pixels, int64_t after) {
  pixels_ = pixels;
  const double now = clock_(), end = (1 - kKept) * settings_.budget_s;
  rows_end_s_ = now + std::max(0.0, end - now) * static_cast<double>(pixels) /
                          static_cast<double>(std::max<int64_t>(1, pixels + after));
  base_end_s_ = rows_end_s_;
  if (settings_.paths) {
    base_end_s_ = std::min(rows_end_s_, now + settings_.base_s * static_cast<double>(pixels));
  }
}

LightRays PicturePace::rays(const LightRays& wanted, int64_t left) const {
  const double point = wanted.gather * gather_rate_ + wanted.shadow * shadow_rate_;
  if (!(point > 0) || left <= 0) return wanted;
  const double time =
      base_end_s_ - clock_() - settings_.after_rays_s * static_cast<double>(pixels_);
  const double factor = std::clamp(time / (point * static_cast<double>(left)), settings_.least,
                                   std::max(settings_.least, settings_.most));
  const auto scaled = [&](int rays) {
    return rays > 0 ? std::max(1, static_cast<int>(factor * rays)) : 0;
  };
  return {scaled(wanted.gather), scaled(wanted.shadow)};
}

void PicturePace::add_rays(const LightRays& rays, const LightWork& work) {
  work_.points += work.points;
  work_.gather_seconds += work.gather_seconds;
  work_.direct_seconds += work.direct_seconds;
  gathered_ += work.points * rays.gather;
  shadowed_ += work.points * rays.shadow;
  if (gathered_ > 0) gather_rate_ = work_.gather_seconds / static_cast<double>(gathered_);
  if (shadowed_ > 0) shadow_rate_ = work_.direct_seconds / static_cast<double>(shadowed_);
}

void PicturePace::begin_paths(int64_t rough, int64_t smooth) {
  rough_ = rough;
  smooth_ = smooth;
  paths_ = {};
}

double PicturePace::pass_paths(const PixelPass& pass) const {
  return 2 *
         (static_cast<double>(rough_) * pass.rough + static_cast<double>(smooth_) * pass.smooth);
}

bool PicturePace::fits(const PixelPass& pass, double share) const {
  const bool smooths = paths_.smooth + pass.smooth > 0;
  const double finish =
      settings_.finish_s * static_cast<double>(pixels_) * (smooths ? 1 : kRoughFinish);
  const double left = rows_end_s_ - clock_() - finish;
  return pass_paths(pass) > 0 && path_rate_ * pass_paths(pass) <= share * left;
}

PixelPass PicturePace::next_pass() {
  pass_begin_s_ = clock_();
  const int most = (kMostPaths - paths_.rough) / kRoughPaths;  // of smooth pixels
  if (!settings_.paths || !(path_rate_ > 0) || most < 1) return {};
  const bool has_smooth = smooth_ > 0;
  if (paths_.rough >= settings_.rough_first || rough_ == 0) {
    const auto many = [&](int count) {
      return PixelPass{kRoughPaths * count, has_smooth ? count : 0};
    };
    const bool first = has_smooth && paths_.smooth == 0;
    int count = first ? kSmoothFirst : most;
    while (!first && count > 1 && !fits(many(count), kShare)) count = count * 3 / 4;
    if (fits(many(count), !first && count > 1 ? kShare : kLast)) return many(count);
  }
  for (int rough = std::max(kRoughPaths, settings_.rough_first - paths_.rough); rough >= 1;
       --rough) {
    if (fits({rough, 0}, rough > 1 ? kShare : kLast)) return {rough, 0};
  }
  return {};
}

void PicturePace::add_pass(const PixelPass& pass) {
  paths_.rough += pass.rough;
  paths_.smooth += pass.smooth;
  if (pass_paths(pass) > 0) path_rate_ = (clock_() - pass_begin_s_) / pass_paths(pass);
}

}  // namespace lte::infer
