#include "infer/eval/measure/bootstrap.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "infer/eval/measure/scores.h"
#include "lte/base/check.h"
#include "lte/base/random.h"

namespace lte::infer {
namespace {

using Statistic = std::function<double(std::vector<double>)>;

/// Interpolates linearly between the order statistics.
double quantile(const std::vector<double>& sorted, double share) {
  const double place = share * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<size_t>(place);
  const size_t above = std::min(below + 1, sorted.size() - 1);
  const double rest = place - static_cast<double>(below);
  // Infinities must not meet a difference of their own.
  if (rest == 0 || sorted[above] == sorted[below]) return sorted[below];
  return sorted[below] + rest * (sorted[above] - sorted[below]);
}

/// The interval of one figure of one predictor, of which `values` has one entry a scene.
Interval figure_interval(const std::vector<double>& values, const Bootstrap& bootstrap,
                         const Statistic& statistic) {
  std::vector<double> drawn;
  return bootstrap.interval([&](std::span<const uint32_t> scenes) {
    drawn.clear();
    for (const uint32_t scene : scenes) {
      if (std::isfinite(values[scene])) drawn.push_back(values[scene]);
    }
    return drawn.empty() ? std::numeric_limits<double>::quiet_NaN() : statistic(drawn);
  });
}

ScoreIntervals intervals(const std::vector<Scores>& scenes, const Bootstrap& bootstrap,
                         const Statistic& statistic) {
  ScoreIntervals out;
  for (const auto& entry : mean_scores(scenes)) {
    const std::string& name = entry.first;
    ScoreInterval bounds;
    const auto measure = [&](auto member, size_t metric) {
      std::vector<double> values;
      for (const Scores& scene : scenes)
        values.push_back((find_score(scene, name)->*member)[metric]);
      const Interval found = figure_interval(values, bootstrap, statistic);
      (bounds.low.*member)[metric] = found.low;
      (bounds.high.*member)[metric] = found.high;
    };
    for (size_t k = 0; k < kPointMetrics.size(); ++k) measure(&Score::points, k);
    for (size_t k = 0; k < kViewMetrics.size(); ++k) measure(&Score::views, k);
    out.emplace_back(name, bounds);
  }
  return out;
}

}  // namespace

Bootstrap::Bootstrap(size_t scenes, const BootstrapSettings& settings)
    : scenes_(scenes), settings_(settings) {
  LTE_CHECK(scenes > 0, "confidence intervals: no scenes");
  LTE_CHECK(settings.resamples > 0, "confidence intervals: expected 1 resample or more, got ",
            settings.resamples);
  LTE_CHECK(settings.level > 0 && settings.level < 1,
            "confidence intervals: expected a level between 0 and 1, got ", settings.level);
  Rng rng(settings.seed);
  draws_.resize(scenes * static_cast<size_t>(settings.resamples));
  for (uint32_t& draw : draws_) draw = static_cast<uint32_t>(rng.below(scenes));
}

Interval Bootstrap::interval(
    const std::function<double(std::span<const uint32_t>)>& statistic) const {
  if (scenes_ < 2) return {kMissing, kMissing};
  std::vector<double> values;
  for (size_t begin = 0; begin < draws_.size(); begin += scenes_) {
    const double value = statistic(std::span<const uint32_t>(draws_).subspan(begin, scenes_));
    if (!std::isnan(value)) values.push_back(value);
  }
  if (values.empty()) return {kMissing, kMissing};
  std::sort(values.begin(), values.end());
  const double tail = 0.5 * (1 - settings_.level);
  return {quantile(values, tail), quantile(values, 1 - tail)};
}

ScoreIntervals mean_intervals(const std::vector<Scores>& scenes, const Bootstrap& bootstrap) {
  return intervals(scenes, bootstrap, mean_of);
}
ScoreIntervals median_intervals(const std::vector<Scores>& scenes, const Bootstrap& bootstrap) {
  return intervals(scenes, bootstrap, median_of);
}

}  // namespace lte::infer
