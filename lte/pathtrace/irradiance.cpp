#include "lte/pathtrace/irradiance.h"

#include <cmath>

#include "lte/pathtrace/irradiance_kernel.h"

namespace lte::pathtrace {
namespace {

constexpr int kMaxRays = 1 << 26;
constexpr int kMaxDepth = 1024;

Rgb sum_groups(const std::vector<Rgb>& values, int64_t groups, int64_t points, int64_t point) {
  Rgb sum;
  for (int64_t g = 0; g < groups; ++g) sum += values[static_cast<size_t>(g * points + point)];
  return sum;
}

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

void PointSums::finish_batch(int size) {
  const auto mean_of = [size](double value) { return kPi * value / size; };
  const Sum batch_indirect{mean_of(batch_indirect_.x), mean_of(batch_indirect_.y),
                           mean_of(batch_indirect_.z)};
  const Sum batch_total{batch_indirect.x + mean_of(batch_direct_.x),
                        batch_indirect.y + mean_of(batch_direct_.y),
                        batch_indirect.z + mean_of(batch_direct_.z)};
  const auto take = [](const Sum& value, Sum* sum, Sum* squares) {
    sum->x += value.x, sum->y += value.y, sum->z += value.z;
    squares->x += value.x * value.x;
    squares->y += value.y * value.y;
    squares->z += value.z * value.z;
  };
  take(batch_indirect, &indirect_mean, &indirect_squares);
  take(batch_total, &total_mean, &total_squares);
  batch_direct_ = batch_indirect_ = {};
}

void PointSums::store(const Batches& batches, int64_t i, Irradiance* out) const {
  const double scale = kPi / (static_cast<double>(batches.count) * batches.size);
  for (size_t g = 0; g < direct.size(); ++g) {
    const auto slot = g * static_cast<size_t>(out->points) + static_cast<size_t>(i);
    const auto scaled = [scale](const Sum& sum) {
      return Rgb{static_cast<float>(sum.x * scale), static_cast<float>(sum.y * scale),
                 static_cast<float>(sum.z * scale)};
    };
    out->direct[slot] = scaled(direct[g]);
    out->indirect[slot] = scaled(indirect[g]);
  }
  const auto variance = [&](double sum, double squares) {
    return static_cast<float>(variance_of_mean(sum, squares, batches.count));
  };
  out->variance[i] = (variance(indirect_mean.x, indirect_squares.x) +
                      variance(indirect_mean.y, indirect_squares.y) +
                      variance(indirect_mean.z, indirect_squares.z)) /
                     3;
  out->variance_total[i] = {variance(total_mean.x, total_squares.x),
                            variance(total_mean.y, total_squares.y),
                            variance(total_mean.z, total_squares.z)};
}

Rgb Irradiance::direct_sum(int64_t point) const {
  return sum_groups(direct, groups, points, point);
}

Rgb Irradiance::indirect_sum(int64_t point) const {
  return sum_groups(indirect, groups, points, point);
}

Rgb Irradiance::total(int64_t point) const { return direct_sum(point) + indirect_sum(point); }

Irradiance estimate_irradiance(const Bvh& bvh, const Lights& lights,
                               std::span<const Vec3> positions, std::span<const Vec3> normals,
                               const IrradianceOptions& options, int64_t first_index) {
  NoRecorder none;
  return run_irradiance(bvh, lights, positions, normals, options, first_index,
                        [&none](int64_t) -> NoRecorder& { return none; });
}

}  // namespace lte::pathtrace
