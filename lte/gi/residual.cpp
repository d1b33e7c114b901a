#include "lte/gi/residual.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "lte/base/check.h"
#include "lte/base/parallel.h"

namespace lte::gi {
namespace {

// Radii to choose from, in spacings, beside the point alone.
constexpr std::array<float, 4> kLadder{1.5f, ResidualField::kLeastRadius, 4, 8};
// Where noise and the prior of a neighbourhood are pooled.
constexpr float kPoolRadius = 4;
// Products of different points that a neighbourhood needs, over those of a point with itself.
constexpr float kLeastPairs = 0.5f;
constexpr int64_t kGrain = 256;
constexpr int64_t kRiskPoints = 4096;  // of which the risk is estimated

Rgb square(const Rgb& c) { return c * c; }

}  // namespace

/// Weighted sums over a neighbourhood.
struct ResidualField::Smooth {
  float weights = 0;
  Rgb mean;         ///< Σ w r / Σ w
  Rgb variance;     ///< Σ w² σ² / (Σ w)²
  Rgb signal;       ///< Σ w (r² − σ²) / Σ w
  float own = 0;    ///< the point's own w / Σ w, if it is known to be among them
  Rgb square;       ///< Σ w r² / Σ w
  Rgb shared;       ///< mean product of r at two different points: what neighbours have in common
  float focus = 1;  ///< Σ w² / (Σ w)²: 1 for a point alone
};

ResidualField::ResidualField(std::vector<Vec3> positions, std::vector<Vec3> normals,
                             std::vector<float> spacing)
    : positions_(std::move(positions)),
      normals_(std::move(normals)),
      spacing_(std::move(spacing)),
      mean_(positions_.size()),
      squares_(positions_.size()),
      noise_(positions_.size()) {
  LTE_CHECK(spacing_.size() == positions_.size(), "residual: ", positions_.size(),
            " positions but ", spacing_.size(), " spacings");
  for (const float radius : kLadder) {
    std::vector<float> radii(spacing_);
    for (float& r : radii) r *= radius;
    indices_.emplace_back(positions_, normals_, radii);
  }
}

void ResidualField::add(std::span<const Rgb> estimates, std::span<const Rgb> answers) {
  LTE_CHECK(estimates.size() == positions_.size() && answers.size() == positions_.size(),
            "residual: ", positions_.size(), " points but ", estimates.size(), " estimates and ",
            answers.size(), " answers");
  for (size_t i = 0; i < estimates.size(); ++i) {
    LTE_CHECK(is_finite(estimates[i]) && is_finite(answers[i]), "residual: estimate or answer ", i,
              " is not finite");
  }
  ++batches_;
  for (size_t i = 0; i < estimates.size(); ++i) {
    const Rgb residual = estimates[i] - answers[i], before = residual - mean_[i];
    mean_[i] += before / static_cast<float>(batches_);
    squares_[i] += before * (residual - mean_[i]);
  }
}

const SurfaceIndex& ResidualField::index(float radius) const {
  return indices_[static_cast<size_t>(std::find(kLadder.begin(), kLadder.end(), radius) -
                                      kLadder.begin())];
}

ResidualField::Smooth ResidualField::smooth(const SurfaceIndex& index, const Vec3& position,
                                            const Vec3& normal) const {
  Smooth out;
  float at_point = 0, weights2 = 0;
  Rgb squares2;
  index.for_each(position, normal, [&](uint32_t i, float weight, const Vec3& offset) {
    out.weights += weight;
    out.mean += mean_[i] * weight;
    out.variance += noise_[i] * (weight * weight);
    out.signal += (square(mean_[i]) - noise_[i]) * weight;
    out.square += square(mean_[i]) * weight;
    squares2 += square(mean_[i]) * (weight * weight);
    weights2 += weight * weight;
    if (offset == Vec3{}) at_point = weight;
  });
  if (!(out.weights > 0)) return {};
  const float scale = 1 / out.weights, pairs = out.weights * out.weights - weights2;
  if (pairs > kLeastPairs * weights2) out.shared = (square(out.mean) - squares2) / pairs;
  out.mean *= scale;
  out.square *= scale;
  out.focus = weights2 * scale * scale;
  out.variance *= scale * scale;
  out.signal *= scale;
  out.own = at_point * scale;
  return out;
}

ResidualField::Smooth ResidualField::own(size_t i) const {
  Smooth out;
  out.weights = out.own = 1;
  out.mean = mean_[i];
  out.variance = noise_[i];
  return out;
}

/// The variance of each point's mean. From few batches it is known badly, so it is pooled over
/// neighbours; from one batch it is not known at all, and stands for half the squared difference
/// between neighbours, whose errors are alike.
void ResidualField::estimate_noise() {
  const auto count = static_cast<float>(batches_);
  const SurfaceIndex& pool = index(kPoolRadius);
  parallel_for(size(), kGrain, [&](int64_t begin, int64_t end) {
    for (auto i = static_cast<size_t>(begin); i < static_cast<size_t>(end); ++i) {
      Rgb sum;
      float weights = 0;
      pool.for_each(positions_[i], normals_[i], [&](uint32_t j, float weight, const Vec3&) {
        if (batches_ > 1) {
          sum += squares_[j] * (weight / (count * (count - 1)));
          weights += weight;
        } else if (j != i) {
          sum += square(mean_[j] - mean_[i]) * (0.5f * weight);
          weights += weight;
        }
      });
      // A point without neighbours keeps all of its difference for noise.
      noise_[i] = weights > 0 ? sum / weights : square(mean_[i]);
    }
  });
}

/// Stein's unbiased estimate of the mean squared error at the points, up to a constant.
double ResidualField::risk(float radius) const {
  const int64_t step = std::max<int64_t>(1, size() / kRiskPoints);
  double sum = 0;
  for (int64_t k = 0; k < size(); k += step) {
    const auto i = static_cast<size_t>(k);
    const Smooth s = radius > 0 ? smooth(index(radius), positions_[i], normals_[i]) : own(i);
    const Rgb miss = square(mean_[i] - s.mean) + noise_[i] * (2 * s.own);
    sum += double{miss.x} + double{miss.y} + double{miss.z};
  }
  return sum;
}

Rgb ResidualField::shrunk(const Smooth& wide, const Smooth& s) const {
  Rgb out;
  for (int c = 0; c < 3; ++c) {
    const float signal = std::max(0.0f, wide.signal[c]);
    if (signal > 0) out[c] = s.mean[c] * signal / (signal + s.variance[c]);
  }
  return out;
}

std::vector<Rgb> ResidualField::correct_points() {
  std::vector<Rgb> out(positions_.size());
  if (batches_ == 0) return out;
  estimate_noise();
  radius_ = 0;
  double best = risk(0);
  for (const float radius : kLadder) {
    const double next = risk(radius);
    if (next < best) {
      best = next;
      radius_ = radius;
    }
  }
  const SurfaceIndex& pool = index(std::max(radius_, kPoolRadius));
  parallel_for(size(), kGrain, [&](int64_t begin, int64_t end) {
    for (auto i = static_cast<size_t>(begin); i < static_cast<size_t>(end); ++i) {
      const Smooth s = radius_ > 0 ? smooth(index(radius_), positions_[i], normals_[i]) : own(i);
      out[i] = shrunk(smooth(pool, positions_[i], normals_[i]), s);
    }
  });
  return out;
}

std::vector<Rgb> ResidualField::correct(std::span<const Vec3> positions,
                                        std::span<const Vec3> normals) const {
  LTE_CHECK(positions.size() == normals.size(), "residual: ", positions.size(), " positions but ",
            normals.size(), " normals");
  std::vector<Rgb> out(positions.size());
  if (batches_ == 0) return out;
  const SurfaceIndex& near = index(std::max(radius_, kLeastRadius));
  const SurfaceIndex& pool = index(std::max(radius_, kPoolRadius));
  parallel_for(static_cast<int64_t>(positions.size()), kGrain, [&](int64_t begin, int64_t end) {
    for (auto i = static_cast<size_t>(begin); i < static_cast<size_t>(end); ++i) {
      const Smooth s = smooth(near, positions[i], normals[i]);
      if (!(s.weights > 0)) continue;
      const Smooth wide = smooth(pool, positions[i], normals[i]);
      for (int c = 0; c < 3; ++c) {
        const float signal = std::max(0.0f, wide.shared[c]);
        const float spread = std::max(0.0f, wide.square[c] - signal) * s.focus;
        if (signal > 0) out[i][c] = s.mean[c] * signal / (signal + spread);
      }
    }
  });
  return out;
}

}  // namespace lte::gi
