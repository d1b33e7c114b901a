#include "experiments/directions/spherical_gaussians.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <ATen/ATen.h>

#include "experiments/directions/nonnegative.h"
#include "lte/base/check.h"

namespace lte::experiments {
namespace {

/// Of the dictionary: from lobes over the whole hemisphere to such as fill one cell of 32 × 32.
constexpr double kWidest = 0.25, kNarrowest = 1000, kStep = 3;

constexpr int kRefinements = 80;

/// exp(λ (μ · ω − 1)), [P, cells, L], of axes [P, L, 3] and sharpness [P, L].
at::Tensor lobes_at(const at::Tensor& directions, const at::Tensor& axis,
                    const at::Tensor& sharpness) {
  return at::matmul(directions, axis.transpose(1, 2)).sub_(1).mul_(sharpness.unsqueeze(1)).exp_();
}

/// [P, L, 3] of the sums that come nearest to the maps.
at::Tensor best_amplitudes(const at::Tensor& basis, const at::Tensor& maps,
                           const at::Tensor& start = {}) {
  const at::Tensor turned = basis.transpose(1, 2);
  return nonnegative_least_squares(at::matmul(turned, basis), at::matmul(turned, maps), start);
}

/// Lobes that a pursuit chooses from.
class Dictionary {
 public:
  explicit Dictionary(const at::Tensor& directions) {
    const at::Tensor below = at::matmul(directions, directions.t()) - 1;
    std::vector<at::Tensor> lobes, axes, sharpness;
    for (double s = kWidest; s <= kNarrowest; s *= kStep) {
      const at::Tensor table = (s * below).exp_();
      lobes.push_back((table / table.norm(2, 1, true)).to(at::kFloat));
      axes.push_back(directions);
      sharpness.push_back(at::full({directions.size(0)}, s, at::kDouble));
    }
    axes_ = at::cat(axes);
    sharpness_ = at::cat(sharpness);
    lobes_ = at::cat(lobes);
  }

  /// For each map of residuals [P, cells, 3], the lobe that takes most of it: axes [P, 1, 3] and
  /// sharpness [P, 1].
  std::pair<at::Tensor, at::Tensor> best(const at::Tensor& residual) const {
    const int64_t P = residual.size(0);
    const at::Tensor columns = residual.to(at::kFloat).permute({1, 0, 2}).flatten(1);
    const at::Tensor score =
        at::matmul(lobes_, columns).clamp_min_(0).square_().view({-1, P, 3}).sum(2);
    const at::Tensor chosen = score.argmax(0);
    return {axes_.index_select(0, chosen).unsqueeze(1),
            sharpness_.index_select(0, chosen).unsqueeze(1)};
  }

 private:
  at::Tensor axes_, sharpness_;
  at::Tensor lobes_;  ///< [lobes, cells] float32, of length 1
};

/// Adam's direction for one parameter (Kingma and Ba, 2015).
class Momentum {
 public:
  at::Tensor step(const at::Tensor& gradient, int iteration) {
    if (!mean_.defined()) {
      mean_ = at::zeros_like(gradient);
      square_ = at::zeros_like(gradient);
    }
    mean_.mul_(kMean).add_(gradient, 1 - kMean);
    square_.mul_(kSquare).addcmul_(gradient, gradient, 1 - kSquare);
    return mean_ / (1 - std::pow(kMean, iteration)) /
           ((square_ / (1 - std::pow(kSquare, iteration))).sqrt_() + 1e-30);
  }

 private:
  static constexpr double kMean = 0.9, kSquare = 0.99;
  at::Tensor mean_, square_;
};

/// Moves axes and sharpness down the gradient; each map keeps the best that it had.
GaussianSums refined(const GaussianSums& first, const at::Tensor& directions,
                     const at::Tensor& maps) {
  GaussianSums now = first, best = first;
  at::Tensor least;  // [P] squared error of `best`
  Momentum of_axis, of_sharpness;
  for (int i = 0; i <= kRefinements; ++i) {
    const at::Tensor basis = lobes_at(directions, now.axis, now.sharpness);
    now.amplitude = best_amplitudes(basis, maps, now.amplitude);
    const at::Tensor residual = at::matmul(basis, now.amplitude).sub_(maps);
    const at::Tensor error = residual.square().sum({1, 2});
    const at::Tensor better = least.defined() ? error < least : at::ones_like(error, at::kBool);
    least = least.defined() ? at::minimum(error, least) : error;
    best.axis = at::where(better.view({-1, 1, 1}), now.axis, best.axis);
    best.sharpness = at::where(better.unsqueeze(1), now.sharpness, best.sharpness);
    best.amplitude = at::where(better.view({-1, 1, 1}), now.amplitude, best.amplitude);
    if (i == kRefinements) break;
    // The amplitudes are at their best, so the error depends on them in second order alone.
    const at::Tensor pull = at::matmul(residual, now.amplitude.transpose(1, 2)).mul_(basis);
    const at::Tensor along = at::matmul(pull.transpose(1, 2), directions);  // [P, L, 3] Σ pull ω
    const at::Tensor cosine = (along * now.axis).sum(2);
    const at::Tensor by_log_sharpness = now.sharpness * (cosine - pull.sum(1));
    // Steps of axes are in units of the lobe's width, 1/√λ, and across the axis.
    const at::Tensor width = now.sharpness.rsqrt().clamp_max(1).unsqueeze(2);
    const at::Tensor across = along - cosine.unsqueeze(2) * now.axis;
    const at::Tensor by_axis = across * (now.sharpness.unsqueeze(2) * width);
    const double rate = 0.08 * (1 - 0.95 * i / kRefinements);
    const at::Tensor axis = now.axis - rate * width * of_axis.step(by_axis, i + 1);
    now.axis = axis / axis.norm(2, 2, true);
    now.sharpness = now.sharpness * (-rate * of_sharpness.step(by_log_sharpness, i + 1)).exp_();
    now.sharpness.clamp_(kWidest / 4, 4 * kNarrowest);
  }
  return best;
}

}  // namespace

at::Tensor GaussianSums::values(const at::Tensor& directions) const {
  return at::matmul(lobes_at(directions, axis, sharpness), amplitude);
}

at::Tensor direction_table(std::span<const Vec3> directions) {
  return at::from_blob(const_cast<Vec3*>(directions.data()),
                       {static_cast<int64_t>(directions.size()), 3}, at::TensorOptions(at::kFloat))
      .to(at::kDouble);
}

GaussianSums fit_lattice(int64_t lobes, const at::Tensor& directions, const at::Tensor& maps) {
  LTE_CHECK(lobes >= 1, "lobes must be positive, got ", lobes);
  const int64_t P = maps.size(0);
  at::Tensor axis = at::empty({1, lobes, 3}, at::kDouble);
  auto* out = axis.data_ptr<double>();
  const auto count = static_cast<double>(lobes);
  for (int64_t i = 0; i < lobes; ++i) {
    const double z = 1 - (static_cast<double>(i) + 0.5) / count, across = std::sqrt(1 - z * z);
    const double azimuth = 2 * std::numbers::pi * static_cast<double>(i) / std::numbers::phi;
    *out++ = across * std::cos(azimuth);
    *out++ = across * std::sin(azimuth);
    *out++ = z;
  }
  // In a hexagonal grid an area a has neighbours at √(2 a / √3). A width 1/√λ of half of that
  // leaves a sum of equal lobes flat to a percent.
  const double apart2 = 2 / std::numbers::sqrt3 * 2 * std::numbers::pi / count;
  const at::Tensor sharpness = at::full({1, lobes}, 4 / apart2, at::kDouble);
  // All maps share the basis: one problem with 3 P right-hand sides.
  const at::Tensor columns = maps.permute({1, 0, 2}).flatten(1).unsqueeze(0);
  const at::Tensor amplitude = best_amplitudes(lobes_at(directions, axis, sharpness), columns);
  return {axis.expand({P, -1, -1}), sharpness.expand({P, -1}),
          amplitude.view({lobes, P, 3}).transpose(0, 1)};
}

std::vector<GaussianSums> fit_greedily(std::span<const int> lobes, const at::Tensor& directions,
                                       const at::Tensor& maps) {
  LTE_CHECK(std::is_sorted(lobes.begin(), lobes.end()) && (lobes.empty() || lobes.front() >= 1),
            "numbers of lobes must be positive and rise");
  const Dictionary dictionary(directions);
  const int64_t P = maps.size(0), cells = maps.size(1);
  GaussianSums sums{at::empty({P, 0, 3}, at::kDouble), at::empty({P, 0}, at::kDouble),
                    at::empty({P, 0, 3}, at::kDouble)};
  at::Tensor basis = at::empty({P, cells, 0}, at::kDouble), residual = maps;
  std::vector<GaussianSums> out;
  for (const int wanted : lobes) {
    while (sums.sharpness.size(1) < wanted) {
      const auto [axis, sharpness] = dictionary.best(residual);
      sums.axis = at::cat({sums.axis, axis}, 1);
      sums.sharpness = at::cat({sums.sharpness, sharpness}, 1);
      basis = at::cat({basis, lobes_at(directions, axis, sharpness)}, 2);
      const at::Tensor start = at::cat({sums.amplitude, at::zeros({P, 1, 3}, at::kDouble)}, 1);
      sums.amplitude = best_amplitudes(basis, maps, start);
      residual = maps - at::matmul(basis, sums.amplitude);
    }
    out.push_back(refined(sums, directions, maps));
  }
  return out;
}

}  // namespace lte::experiments
