#include "infer/picture/ray_pace.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace lte::infer {
namespace {

/// Share of the time that is given out: blocks differ, and the last one is not to be late.
constexpr double kGiven = 0.92;

}  // namespace

int whole_rays(double rays) {
  const double most = std::clamp(rays, 1.0, 1e6);
  const int unit = most < 8 ? 1 : most < 64 ? 8 : 64;
  return static_cast<int>(std::floor(most / unit)) * unit;
}

RayPace::RayPace(double budget_s, double second_a_ray, int most, std::function<double()> clock)
    : budget_s_(budget_s), rate_(second_a_ray), most_(most), clock_(std::move(clock)) {}

void RayPace::begin_rows(int64_t pixels, int64_t after) {
  if (start_s_ < 0) start_s_ = clock_();
  begun_ += pixels;
  rows_ = pixels;
  after_ = after;
}

double RayPace::second_a_ray() const {
  return cast_ > 0 ? direct_s_ / static_cast<double>(cast_) : rate_;
}

/// What the rows below take beside direct light.
double RayPace::reserve(int64_t pixels) const {
  if (begun_ == 0) return 0;
  const double other = std::max(0.0, clock_() - start_s_ - direct_s_);
  return other * static_cast<double>(pixels) / static_cast<double>(begun_);
}

int RayPace::rays(int64_t left) {
  // Rows below ask as much a pixel as these: at most one query, and those of anti-aliasing.
  const double queries = static_cast<double>(left) + static_cast<double>(after_);
  const double rate = second_a_ray();
  if (!(rate > 0) || !(queries > 0)) return whole_rays(most_);
  const double time = kGiven * (seconds_left() - reserve(after_));
  return std::min(whole_rays(std::max(1.0, time / (rate * queries))), most_);
}

void RayPace::add(int64_t queries, int rays, double seconds) {
  queries_ += queries;
  cast_ += queries * rays;
  direct_s_ += seconds;
}

bool RayPace::late() const {
  const double least = second_a_ray() * static_cast<double>(rows_ + after_);
  return seconds_left() - reserve(after_) < least;
}

double RayPace::mean_rays() const {
  return queries_ > 0 ? static_cast<double>(cast_) / static_cast<double>(queries_) : 0;
}

}  // namespace lte::infer
