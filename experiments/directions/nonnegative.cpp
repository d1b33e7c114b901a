#include "experiments/directions/nonnegative.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <ATen/ATen.h>
#include <ATen/Parallel.h>

#include "lte/base/check.h"

namespace lte::experiments {
namespace {

constexpr double kRidge = 1e-10;
constexpr double kTolerance = 1e-10;

/// One problem; x is what is known so far.
class ActiveSet {
 public:
  ActiveSet(const double* gram, std::vector<double> moments, std::vector<double> x)
      : n_(moments.size()), gram_(gram), moments_(std::move(moments)), x_(std::move(x)) {
    for (size_t i = 0; i < n_; ++i) {
      scale_.push_back(std::sqrt(gram[i * n_ + i]));
      if (x_[i] > 0) free_.push_back(i);
    }
  }

  const std::vector<double>& solve() {
    double largest = 0;
    for (size_t i = 0; i < n_; ++i) largest = std::max(largest, moments_[i] / scale_[i]);
    settle();
    for (size_t round = 0; round < 4 * n_; ++round) {
      const size_t best = steepest();
      if (best == n_ || slope(best) <= kTolerance * largest * scale_[best]) break;
      free_.push_back(best);
      settle();
      // Rounding alone made it look worth while, and would for ever.
      if (free_.empty() || free_.back() != best) break;
    }
    return x_;
  }

 private:
  /// Half of minus the derivative of the squared error by x_i.
  double slope(size_t i) const {
    double sum = moments_[i];
    for (const size_t j : free_) sum -= gram_[i * n_ + j] * x_[j];
    return sum;
  }

  /// That at 0 whose increase pays most for its length; n_ if all are free.
  size_t steepest() const {
    size_t best = n_;
    double most = 0;
    for (size_t i = 0; i < n_; ++i) {
      if (std::find(free_.begin(), free_.end(), i) != free_.end()) continue;
      const double pays = slope(i) / scale_[i];
      if (best != n_ && pays <= most) continue;
      best = i;
      most = pays;
    }
    return best;
  }

  /// Goes to the least squares of those that are free, as far as none of them becomes negative;
  /// these are fixed at 0, and so on.
  void settle() {
    while (!free_.empty()) {
      const std::vector<double> wanted = unbounded();
      double step = 1;
      for (size_t k = 0; k < free_.size(); ++k) {
        const double now = x_[free_[k]];
        if (wanted[k] <= 0) step = std::min(step, now / std::max(now - wanted[k], 1e-300));
      }
      std::vector<size_t> still;
      for (size_t k = 0; k < free_.size(); ++k) {
        double& x = x_[free_[k]];
        const bool ends = wanted[k] <= 0 && x <= step * (x - wanted[k]) * (1 + 1e-12);
        x = ends ? 0 : x + step * (wanted[k] - x);
        if (!ends) still.push_back(free_[k]);
      }
      const bool all = still.size() == free_.size();
      free_ = std::move(still);
      if (all) return;
    }
  }

  /// Least squares of those that are free, by Cholesky's decomposition.
  std::vector<double> unbounded() const {
    const size_t m = free_.size();
    std::vector<double> factor(m * m), y(m);
    for (size_t i = 0; i < m; ++i) {
      for (size_t j = 0; j <= i; ++j) {
        double sum = gram_[free_[i] * n_ + free_[j]] * (i == j ? 1 + kRidge : 1);
        for (size_t k = 0; k < j; ++k) sum -= factor[i * m + k] * factor[j * m + k];
        if (i == j) {
          const double least = kRidge * gram_[free_[i] * n_ + free_[i]];
          factor[i * m + i] = std::sqrt(std::max(sum, least));
        } else {
          factor[i * m + j] = sum / factor[j * m + j];
        }
      }
      double sum = moments_[free_[i]];
      for (size_t k = 0; k < i; ++k) sum -= factor[i * m + k] * y[k];
      y[i] = sum / factor[i * m + i];
    }
    for (size_t i = m; i-- > 0;) {
      for (size_t k = i + 1; k < m; ++k) y[i] -= factor[k * m + i] * y[k];
      y[i] /= factor[i * m + i];
    }
    return y;
  }

  size_t n_;
  const double* gram_;
  std::vector<double> moments_, x_, scale_;
  std::vector<size_t> free_;  ///< those that are not held at 0
};

}  // namespace

at::Tensor nonnegative_least_squares(const at::Tensor& gram, const at::Tensor& moments,
                                     const at::Tensor& start) {
  const int64_t B = gram.size(0), L = gram.size(1), T = moments.size(2);
  LTE_CHECK(gram.size(2) == L && moments.size(0) == B && moments.size(1) == L,
            "normal equations of different sizes");
  const at::Tensor grams = gram.contiguous(), sides = moments.transpose(1, 2).contiguous();
  at::Tensor out = start.defined() ? start.transpose(1, 2).contiguous().clone()
                                   : at::zeros({B, T, L}, at::kDouble);
  const double *gram_data = grams.const_data_ptr<double>(),
               *side_data = sides.const_data_ptr<double>();
  auto* x = out.data_ptr<double>();
  at::parallel_for(0, B * T, 1, [&](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end; ++i) {
      const double* side = side_data + i * L;
      const std::vector<double> answer =
          ActiveSet(gram_data + i / T * L * L, {side, side + L}, {x + i * L, x + (i + 1) * L})
              .solve();
      std::copy(answer.begin(), answer.end(), x + i * L);
    }
  });
  return out.transpose(1, 2).contiguous();
}

}  // namespace lte::experiments
