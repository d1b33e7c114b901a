// Confidence intervals over scenes by the bootstrap (Efron 1979), percentile method.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "infer/eval/measure/scores.h"

namespace lte::infer {

struct BootstrapSettings {
  int resamples = 2000;
  uint64_t seed = 1;
  double level = 0.95;
};

/// Bounds of a figure. NaN where there was nothing to measure, and of one scene, which says nothing
/// about others.
struct Interval {
  double low, high;
};

/// Draws as many scenes as there are, with replacement, `resamples` times. The draws are the same
/// for every figure, so that figures of one resample belong together.
class Bootstrap {
 public:
  /// @throws lte::Error unless there is a scene, a resample, and a level inside (0, 1).
  Bootstrap(size_t scenes, const BootstrapSettings& settings);

  /// @param statistic  computes the figure of the scenes with these indices; a resample for which
  ///                   it is NaN is left out, an infinity counts
  Interval interval(const std::function<double(std::span<const uint32_t>)>& statistic) const;

  const BootstrapSettings& settings() const { return settings_; }

 private:
  size_t scenes_;
  BootstrapSettings settings_;
  std::vector<uint32_t> draws_;  ///< [resamples, scenes]
};

/// Both bounds of every figure of a predictor.
struct ScoreInterval {
  Score low, high;
};
using ScoreIntervals = std::vector<std::pair<std::string, ScoreInterval>>;

/// Intervals of the figures of mean_scores() and median_scores().
ScoreIntervals mean_intervals(const std::vector<Scores>& scenes, const Bootstrap& bootstrap);
ScoreIntervals median_intervals(const std::vector<Scores>& scenes, const Bootstrap& bootstrap);

}  // namespace lte::infer
