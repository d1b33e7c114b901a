// Gradients of weights: Σ_i left[i]ᵀ right[i] over the rows of a layer's inputs and of the gradient
// by its outputs, in float32, or both rounded to bfloat16 with sums in float32.
#pragma once

#include <cstdint>
#include <vector>

#include "lte/ops/cpu/kernels/kernels.h"
#include "lte/tensor/tensor.h"

namespace lte::ops {

/// Rows of a contiguous matrix of `C` columns, in float32 or already rounded to bfloat16.
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
  /// @param bf16  whether rows in float32 are rounded, too; else none has been
  explicit WeightGradient(bool bf16)
      : bf16_(bf16),
        left_(static_cast<size_t>(kRows * kPanel), bf16),
        right_(static_cast<size_t>(kRows * kPanel), bf16),
        product_(static_cast<size_t>(kPanel * kPanel)) {}

  /// out[l][r] += Σ_i left[i][l] right[i][r] over rows [begin, end) and one panel of columns of
  /// each.
  /// @param out  [left.C, right.C]
  void add(const GradientRows& left, int64_t left_panel, const GradientRows& right,
           int64_t right_panel, int64_t begin, int64_t end, float* out);

 private:
  static constexpr int64_t kRows = 128;  ///< multiplied at once

  /// A panel of some rows, as numbers or as pairs of two rows.
  struct Factor {
    std::vector<float> single;
    std::vector<uint32_t> pairs;

    Factor(size_t size, bool bf16) : single(bf16 ? 0 : size), pairs(bf16 ? size / 2 : 0) {}
    void take(const GradientRows& from, int64_t first, int64_t rows, int64_t column,
              int64_t columns);
  };

  bool bf16_;
  Factor left_, right_;
  std::vector<float> product_;
};

}  // namespace lte::ops
