// Learning the light of one scene by heart: parameters that are that scene's alone, fitted to some
// of its query points.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include <ATen/core/Tensor.h>

namespace lte::train {

/// What is learnt, and from what.
struct ByHeart {
  std::vector<at::Tensor> parameters;
  /// [n, 3] at some rows [n] int64 of the queries, non-negative, differentiable.
  std::function<at::Tensor(const at::Tensor& rows)> answer;
  at::Tensor target;  ///< [Q, 3], of a mean near 1; may be noisy
  at::Tensor learnt;  ///< rows of the target that are shown
};

struct ByHeartLimits {
  double seconds = std::numeric_limits<double>::infinity();  ///< of `clock`, in steps alone
  int64_t steps = std::numeric_limits<int64_t>::max();
  std::function<double()> clock;
  double rate = 3e-3;  ///< of Adam at the start; it falls to a hundredth along half a cosine
  /// Of the relative loss: the larger, the less dark places count beside bright ones.
  double epsilon = 0.01;
  int64_t batch = 4096;
};

/// Minimizes the relative loss in linear space, whose least value over noisy targets is their mean,
/// until the first of the limits.
/// @param look  is told of steps and seconds after each step; false ends the learning
/// @return steps
int64_t learn_by_heart(const ByHeart& task, const ByHeartLimits& limits,
                       const std::function<bool(int64_t steps, double seconds)>& look);

}  // namespace lte::train
