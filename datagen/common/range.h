// Ranges that configurations draw from.
#pragma once

#include <cmath>
#include <cstdint>

#include "lte/base/random.h"

namespace lte::datagen {

struct Range {
  double low = 0, high = 0;
};
struct CountRange {
  int64_t low = 0, high = 0;
};

/// A number in `range`, whose logarithm is drawn evenly.
inline float log_uniform(const Range& range, Rng* rng) {
  const double low = std::log(range.low), high = std::log(range.high);
  return static_cast<float>(std::exp(low + (high - low) * rng->uniform()));
}

}  // namespace lte::datagen
