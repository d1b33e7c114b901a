#include "lte/pathtrace/transport/irradiance_kernel.h"

#include <algorithm>
#include <cmath>

#include "lte/scene/number_check.h"

namespace lte::pathtrace {
namespace {

constexpr int kMaxRays = 1 << 26;
constexpr int kMaxDepth = 1024;

/// Unbiased variance of the mean of `count` independent values; rounding below zero is cut off.
double variance_of_mean(double sum, double squares, int count) {
  const double mean = sum / count;
  return std::max(0.0, squares / count - mean * mean) / (count - 1);
}

}  // namespace

Batches plan_batches(int rays) {
  if (rays <= 8) return {std::max(rays, 2), 1};
  const int count = rays < 4096 ? 8 : 16;
  const int block = rays <= 64 ? 1 : 64 / count;
  const int size = (rays + count - 1) / count;
  return {count, (size + block - 1) / block * block};
}

void check_points(std::span<const Vec3> positions, std::span<const Vec3> normals) {
  LTE_CHECK(positions.size() == normals.size(), "irradiance needs one normal a position: got ",
            positions.size(), " positions and ", normals.size(), " normals");
  for (size_t i = 0; i < positions.size(); ++i) {
    LTE_CHECK(is_finite(positions[i]), "position ", i, " is not finite");
    LTE_CHECK(scene::is_place(positions[i]), "position ", i, " is farther than ",
              scene::kMaxCoordinate, " from the origin");
    LTE_CHECK(is_finite(normals[i]), "normal ", i, " is not finite");
    LTE_CHECK(std::fabs(dot(normals[i], normals[i]) - 1) < 1e-3f, "normal ", i,
              " is not a unit vector: its length is ", length(normals[i]));
  }
}

void check_irradiance_options(const IrradianceOptions& options) {
  LTE_CHECK(options.rays >= 1 && options.rays <= kMaxRays, "rays must be 1 to ", kMaxRays, ", got ",
            options.rays);
  LTE_CHECK(options.max_depth >= 1 && options.max_depth <= kMaxDepth, "max_depth must be 1 to ",
            kMaxDepth, ", got ", options.max_depth);
  LTE_CHECK(options.roulette_depth >= 1, "roulette_depth must be at least 1, got ",
            options.roulette_depth);
}

void PointSums::start_point() {
  std::fill(direct_.begin(), direct_.end(), Sum{});
  std::fill(indirect_.begin(), indirect_.end(), Sum{});
  std::fill(last_.begin(), last_.end(), Sum{});
  std::fill(batch_.begin(), batch_.end(), BatchSum{});
  std::fill(gray_.begin(), gray_.end(), 0.0);
}

void PointSums::add(int depth, std::span<const Contribution> contributions) {
  std::vector<Sum>& groups = depth == 1 ? direct_ : indirect_;
  Sum BatchSum::*const part = depth == 1 ? &BatchSum::direct : &BatchSum::indirect;
  for (const Contribution& c : contributions) {
    const size_t group = groups.size() == 1 ? 0 : static_cast<size_t>(c.light_group);
    groups[group].add(c.value);
    if (depth == last_depth_) last_[group].add(c.value);
    const int32_t batch = batch_of_path_[static_cast<size_t>(c.path)];
    (batch_[static_cast<size_t>(batch)].*part).add(c.value);
    if (depth > 1 && !gray_.empty()) {
      const size_t row = group * batch_.size();
      gray_[row + static_cast<size_t>(batch)] += (c.value.x + c.value.y + c.value.z) / 3;
    }
  }
}

void PointSums::store(int64_t i, Irradiance* out) const {
  const double scale = kPi / (static_cast<double>(batches_.count) * batches_.size);
  for (size_t g = 0; g < direct_.size(); ++g) {
    const auto slot = g * static_cast<size_t>(out->points) + static_cast<size_t>(i);
    const auto scaled = [scale](const Sum& sum) {
      return Rgb{static_cast<float>(sum.x * scale), static_cast<float>(sum.y * scale),
                 static_cast<float>(sum.z * scale)};
    };
    out->direct[slot] = scaled(direct_[g]);
    out->indirect[slot] = scaled(indirect_[g]);
    if (!last_.empty()) out->last[slot] = scaled(last_[g]);
  }
  if (out->variance.empty()) return;  // not asked for
  const auto variance = [this](const auto& value_of) {
    double sum = 0, squares = 0;
    for (const BatchSum& batch : batch_) {
      const double mean = kPi * value_of(batch) / batches_.size;
      sum += mean;
      squares += mean * mean;
    }
    return static_cast<float>(variance_of_mean(sum, squares, batches_.count));
  };
  Rgb indirect, total;
  double Sum::*const channels[] = {&Sum::x, &Sum::y, &Sum::z};
  for (int c = 0; c < 3; ++c) {
    const auto channel = channels[c];
    indirect[c] = variance([=](const BatchSum& b) { return b.indirect.*channel; });
    total[c] = variance([=](const BatchSum& b) { return b.direct.*channel + b.indirect.*channel; });
  }
  out->variance[i] = (indirect.x + indirect.y + indirect.z) / 3;
  out->variance_total[i] = total;
  for (size_t g = 0; !gray_.empty() && g < direct_.size(); ++g) {
    double sum = 0, squares = 0;
    for (size_t batch = 0; batch < batch_.size(); ++batch) {
      const double mean = kPi * gray_[g * batch_.size() + batch] / batches_.size;
      sum += mean;
      squares += mean * mean;
    }
    out->group_variance[g * static_cast<size_t>(out->points) + static_cast<size_t>(i)] =
        static_cast<float>(variance_of_mean(sum, squares, batches_.count));
  }
}

}  // namespace lte::pathtrace
