// Gradients of weights in bfloat16: Σ_i left[i]ᵀ right[i] over the rows of a layer's inputs and of
// the gradient by its outputs, both rounded, with sums in float32.
#pragma once

#include <cstdint>
#include <vector>

#include <c10/util/BFloat16.h>

#include "lte/ops/cpu/kernels/kernels.h"

namespace lte::ops {

/// Rows of a contiguous matrix of `C` columns, in float32 or already rounded.
struct GradientRows {
  const float* single;
  const at::BFloat16* half;  ///< where `single` is null
  int64_t C;
  const int32_t* index = nullptr;  ///< which rows; null: all, in their order

  int64_t row(int64_t i) const { return index != nullptr ? index[i] : i; }
};

/// One thread's working memory.
class WeightGradient {
 public:
  /// out[l][r] += Σ_i left[i][l] right[i][r] over rows [begin, end) and one panel of columns of
  /// each.
  /// @param out  [left.C, right.C]
  void add(const GradientRows& left, int64_t left_panel, const GradientRows& right,
           int64_t right_panel, int64_t begin, int64_t end, float* out);

 private:
  static constexpr int64_t kPairs = 64;  ///< multiplied at once, 32 KiB of either side

  std::vector<uint32_t> left_ = std::vector<uint32_t>(kPairs * kPanel);
  std::vector<uint32_t> right_ = std::vector<uint32_t>(kPairs * kPanel);
  std::vector<float> product_ = std::vector<float>(kPanel * kPanel);
};

}  // namespace lte::ops
