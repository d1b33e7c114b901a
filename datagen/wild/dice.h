// Random draws in the forms that the wild generator needs.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "datagen/common/range.h"
#include "lte/base/random.h"

namespace lte::datagen::wild {

struct Dice {
  Rng rng;

  float draw(float low, float high) { return rng.uniform(low, high); }
  /// Log-uniform in [low, high], both positive.
  float log_draw(float low, float high) { return log_uniform({low, high}, &rng); }
  /// In [low, high], both included.
  int count(int low, int high) {
    return low + static_cast<int>(rng.below(static_cast<uint64_t>(int64_t{high} - low + 1)));
  }
  bool chance(float probability) { return rng.uniform() < probability; }
  /// An index with the probability of its share; shares need not sum to 1.
  template <size_t N>
  int pick(const std::array<float, N>& shares) {
    float sum = 0, at = 0;
    for (const float share : shares) sum += share;
    const float target = rng.uniform() * sum;
    for (size_t i = 0; i + 1 < N; ++i)
      if ((at += shares[i]) > target) return static_cast<int>(i);
    return static_cast<int>(N) - 1;
  }
};

}  // namespace lte::datagen::wild
