#include "train/data/query_scores.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

namespace lte::train {
namespace {

/// Mean over channels of the sum over groups, [N].
std::vector<double> brightness(const std::vector<Rgb>& groups, size_t queries) {
  std::vector<double> sums(queries, 0.0);
  for (size_t i = 0; i < groups.size(); ++i)
    sums[i % queries] += (double{groups[i].x} + groups[i].y + groups[i].z) / 3;
  return sums;
}

/// Morton code of a position in `bounds`, ten bits an axis.
uint32_t curve_place(const Vec3& position, const Bounds& bounds) {
  constexpr uint32_t kCells = 1u << 10;
  const float width = std::max(max_component(bounds.extent()), 1e-30f);
  uint32_t code = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const float place = (position[axis] - bounds.low[axis]) / width * kCells;
    const uint32_t cell = std::min(static_cast<uint32_t>(std::max(place, 0.0f)), kCells - 1);
    for (uint32_t bit = 0; bit < 10; ++bit)
      code |= ((cell >> bit) & 1u) << (3 * bit + static_cast<uint32_t>(axis));
  }
  return code;
}

}  // namespace

std::vector<float> query_noise(const data::SceneSample& sample) {
  const auto N = static_cast<size_t>(sample.query_points());
  const std::vector<double> mean = brightness(sample.indirect, N);
  std::vector<float> noise(N, 0.0f);
  for (size_t i = 0; i < N; ++i) {
    constexpr double kMost = 1e6;  // a reference that says nothing at all
    if (mean[i] > 0)
      noise[i] = static_cast<float>(std::min(kMost, sample.variance[i] / (mean[i] * mean[i])));
  }
  return noise;
}

std::vector<float> query_slope(const std::vector<Vec3>& position, const std::vector<Vec3>& normal,
                               const std::vector<Rgb>& target) {
  const size_t N = position.size();
  const std::vector<double> value = brightness(target, N);
  const double mean = std::accumulate(value.begin(), value.end(), 0.0) / static_cast<double>(N);
  std::vector<float> slope(N, 0.0f);
  if (!(mean > 0)) return slope;
  Bounds bounds;
  for (const Vec3& p : position) bounds.extend(p);
  std::vector<uint32_t> place(N);
  for (size_t i = 0; i < N; ++i) place[i] = curve_place(position[i], bounds);
  std::vector<size_t> order(N);
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](size_t a, size_t b) { return place[a] < place[b]; });
  const float nearest = 1e-3f * max_component(bounds.extent());  // noise must not look like an edge
  constexpr size_t kReach = 3;
  constexpr float kSameSide = 0.9f;
  for (size_t k = 0; k < N; ++k) {
    for (size_t next = k + 1; next < std::min(N, k + 1 + kReach); ++next) {
      const size_t i = order[k], j = order[next];
      if (dot(normal[i], normal[j]) < kSameSide) continue;
      const double change = std::abs(std::log1p(value[i] / mean) - std::log1p(value[j] / mean));
      const float distance = std::max(length(position[i] - position[j]), nearest);
      if (!(distance > 0)) continue;
      const auto steepness = static_cast<float>(change / distance);
      slope[i] = std::max(slope[i], steepness);
      slope[j] = std::max(slope[j], steepness);
    }
  }
  return slope;
}

}  // namespace lte::train
