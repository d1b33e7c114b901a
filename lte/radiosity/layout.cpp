#include "lte/radiosity/layout.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "lte/base/morton.h"
#include "lte/radiosity/constants.h"

namespace lte::radiosity {

Layout::Layout(const Points& points)
    : points_(points),
      count_(points.position.size()),
      blockers_(choose_roles()),
      grid_(blockers_.position, blockers_.normal, kCellSpacings * spacing_) {
  cluster_luminaires();
}

/// Sorts points into those that emit and those that do not, and returns what blocks the view: the
/// latter, and luminaires among them. Lights of the sky stand far outside.
Layout::Blockers Layout::choose_roles() {
  Blockers blockers;
  Bounds bounds;
  for (size_t i = 0; i < count_; ++i) {
    (emits(i) ? luminaires_ : dark_).push_back(i);
    if (emits(i)) continue;
    dark_area_ += points_.area[i];
    blockers.add(points_.position[i], points_.normal[i]);
    bounds.extend(points_.position[i]);
  }
  const auto dark = static_cast<double>(std::max<size_t>(dark_.size(), 1));
  spacing_ = static_cast<float>(std::sqrt(dark_area_ / dark));
  for (const size_t i : luminaires_) {
    const Vec3& p = points_.position[i];
    if (min(p, bounds.low) == bounds.low && max(p, bounds.high) == bounds.high)
      blockers.add(p, points_.normal[i]);
  }
  return blockers;
}

/// Brings luminaires into the order of their clusters. Each that stands outside the grid has one of
/// its own.
void Layout::cluster_luminaires() {
  const double finer = std::max(1.0, static_cast<double>(count_) / kFinestClusters);
  const GridShape cubes = GridShape::around(
      blockers_.position, kClusterSpacings * spacing_ * static_cast<float>(std::sqrt(finer)));
  const auto alone = static_cast<int64_t>(std::numeric_limits<int32_t>::max());
  std::vector<std::pair<int64_t, size_t>> keyed;
  for (const size_t i : luminaires_) {
    const Vec3& n = points_.normal[i];
    int64_t facing = 0;
    for (int axis = 0; axis < 3; ++axis)
      facing = 3 * facing + (n[axis] > kMinAxisCosine ? 2 : n[axis] < -kMinAxisCosine ? 1 : 0);
    const std::optional<int32_t> cell = cubes.cell_of(points_.position[i]);
    keyed.emplace_back(cell ? 27 * int64_t{*cell} + facing : 27 * (alone + static_cast<int64_t>(i)),
                       i);
  }
  std::sort(keyed.begin(), keyed.end());
  for (size_t k = 0; k < keyed.size(); ++k) {
    luminaires_[k] = keyed[k].second;
    if (k == 0 || keyed[k].first != keyed[k - 1].first) clusters_.push_back({k, k, {}});
    clusters_.back().last = k + 1;
  }
  for (Cluster& cluster : clusters_)
    cluster.middle = points_.position[luminaires_[middle_of(cluster)]];
}

/// The luminaire that is nearest to the mean of its cluster.
size_t Layout::middle_of(const Cluster& cluster) const {
  Vec3 mean;
  for (size_t k = cluster.first; k < cluster.last; ++k)
    mean += points_.position[luminaires_[k]] / static_cast<float>(cluster.last - cluster.first);
  size_t best = cluster.first;
  float least = std::numeric_limits<float>::infinity();
  for (size_t k = cluster.first; k < cluster.last; ++k) {
    const float distance = length(points_.position[luminaires_[k]] - mean);
    if (distance < least) least = distance, best = k;
  }
  return best;
}

std::vector<Sender> Layout::choose_senders(std::span<const Sides> direct, int64_t groups,
                                           size_t wanted) const {
  std::vector<Sender> senders;
  const auto add = [&](size_t i, double points) {
    senders.push_back({i, static_cast<float>(points_.area[i] * points)});
  };
  if (dark_.size() <= wanted) {
    for (const size_t i : dark_) add(i, 1);
    return senders;
  }
  const std::vector<double> importance = importance_of_senders(direct, groups);
  const double total = std::accumulate(importance.begin(), importance.end(), 0.0);
  if (wanted == 0 || !(total > 0)) return senders;
  const double step = total / static_cast<double>(wanted);
  double passed = 0;
  int64_t marks = 0;  // passed, of one in the middle of each step
  for (const size_t k : along_curve()) {
    passed += importance[k];
    const int64_t times = int64_t{std::llround(passed / step)} - marks;
    if (times == 0) continue;
    marks += times;
    add(dark_[k], static_cast<double>(times) * step / importance[k]);
  }
  return senders;
}

/// Of each dark point; they add up to 1, or to 0 where there is no area.
std::vector<double> Layout::importance_of_senders(std::span<const Sides> direct,
                                                  int64_t groups) const {
  // Groups alike: which of them is bright is not known yet.
  std::vector<double> reflected(dark_.size());
  double lit_groups = 0;
  for (int64_t g = 0; g < groups; ++g) {
    const auto power = [&](size_t i) {
      const auto& [front, back] = direct[static_cast<size_t>(g) * count_ + i];
      const Rgb light = points_.albedo[i] * (front + back);
      return points_.area[i] * (double{light.x} + light.y + light.z);
    };
    double sum = 0;
    for (const size_t i : dark_) sum += power(i);
    if (!(sum > 0 && std::isfinite(sum))) continue;
    ++lit_groups;
    for (size_t k = 0; k < dark_.size(); ++k) reflected[k] += power(dark_[k]) / sum;
  }
  std::vector<double> importance(dark_.size());
  if (!(dark_area_ > 0)) return importance;
  const double by_light = lit_groups > 0 ? kShareByLight : 0;
  for (size_t k = 0; k < dark_.size(); ++k)
    importance[k] = (1 - by_light) * points_.area[dark_[k]] / dark_area_ +
                    by_light * reflected[k] / std::max(lit_groups, 1.0);
  return importance;
}

/// Places in `dark_` along Morton's curve.
std::vector<size_t> Layout::along_curve() const {
  const GridShape cubes = GridShape::around(blockers_.position, spacing_);
  std::vector<std::pair<uint64_t, size_t>> keyed;
  for (size_t k = 0; k < dark_.size(); ++k) {
    const Vec3 cube = cubes.place(points_.position[dark_[k]]);
    keyed.emplace_back(morton_code({static_cast<uint32_t>(cube.x), static_cast<uint32_t>(cube.y),
                                    static_cast<uint32_t>(cube.z)}),
                       k);
  }
  std::sort(keyed.begin(), keyed.end());
  std::vector<size_t> order;
  order.reserve(keyed.size());
  for (const auto& [code, k] : keyed) order.push_back(k);
  return order;
}

}  // namespace lte::radiosity
