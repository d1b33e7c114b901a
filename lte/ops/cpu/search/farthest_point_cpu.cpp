// Farthest point sampling on the CPU: exact, but a pick only visits the buckets of points it can
// come nearer to.
#include <algorithm>
#include <limits>
#include <vector>

#include "lte/ops/cpu/kernels/kernels.h"
#include "lte/ops/cpu/search/kd_tree.h"
#include "lte/ops/farthest_point_args.h"
#include "lte/tensor/functions.h"
#include "lte/tensor/library.h"

namespace lte::ops {
namespace {

constexpr int kBucketSize = 64;
constexpr float kPicked = -1;  ///< below every distance: a point is picked once

/// Bounds and reaches of buckets or of groups of them, as the kernels read them.
struct Boxes {
  int64_t stride;
  std::vector<float> box;    ///< low x, y, z and high x, y, z, each `stride` long
  std::vector<float> reach;  ///< largest distance to the picks inside

  explicit Boxes(int64_t count)
      : stride(count + KdTree::kPadding), box(6 * stride), reach(stride, kPicked) {
    std::fill(box.begin(), box.begin() + 3 * stride, std::numeric_limits<float>::infinity());
    std::fill(box.begin() + 3 * stride, box.end(), -std::numeric_limits<float>::infinity());
  }

  void extend(int64_t i, const KdTree::Node& node) {
    for (int axis = 0; axis < 3; ++axis) {
      float& low = box[axis * stride + i];
      float& high = box[(axis + 3) * stride + i];
      low = std::min(low, node.low[axis]);
      high = std::max(high, node.high[axis]);
    }
  }
};

/// Buckets of points, and groups of consecutive buckets, so that a pick looks at few of either.
class Sampler {
 public:
  explicit Sampler(const KdTree& tree)
      : tree_(tree),
        kernels_(point_kernels()),
        count_(static_cast<int64_t>(tree.leaves.size())),
        groups_((count_ + kGroup - 1) / kGroup),
        bucket_(count_),
        group_(groups_),
        farthest_(count_),
        row_(count_),
        leader_(groups_),
        reached_groups_(groups_ + KdTree::kPadding),
        reached_buckets_(kGroup + KdTree::kPadding),
        distance_(tree.index.size() + KdTree::kPadding, std::numeric_limits<float>::infinity()) {
    for (int64_t b = 0; b < count_; ++b) {
      bucket_.extend(b, node(b));
      group_.extend(b / kGroup, node(b));
      bucket_.reach[b] = std::numeric_limits<float>::infinity();
      farthest_[b] = node(b).begin;
      row_[b] = tree_.index[node(b).begin];
    }
    for (int64_t g = 0; g < groups_; ++g) find_leader(g);
  }

  /// The bucket whose farthest point is the farthest of all; by row among equals.
  int64_t farthest_bucket() const {
    int64_t best = leader_[0];
    for (int64_t g = 1; g < groups_; ++g) {
      if (precedes(leader_[g], best)) best = leader_[g];
    }
    return best;
  }

  float reach(int64_t b) const { return bucket_.reach[b]; }
  int32_t row(int64_t b) const { return row_[b]; }

  /// Picks the farthest point of a bucket.
  void pick(int64_t picked) {
    const int64_t position = farthest_[picked];
    const float point[3] = {tree_.x[position], tree_.y[position], tree_.z[position]};
    distance_[position] = kPicked;
    // Visits the pick's own bucket even if all else in it coincides with the pick.
    bucket_.reach[picked] = group_.reach[picked / kGroup] = std::numeric_limits<float>::infinity();
    // A group or bucket with nothing farther than the distance of its box cannot change.
    const int64_t groups = kernels_.reached(group_.box.data(), group_.stride, groups_, point,
                                            group_.reach.data(), reached_groups_.data());
    for (int64_t i = 0; i < groups; ++i) {
      const int64_t first = reached_groups_[i] * kGroup;
      const int64_t buckets = kernels_.reached(
          bucket_.box.data() + first, bucket_.stride, std::min(kGroup, count_ - first), point,
          bucket_.reach.data() + first, reached_buckets_.data());
      for (int64_t j = 0; j < buckets; ++j) relax(first + reached_buckets_[j], point);
      if (buckets > 0) find_leader(reached_groups_[i]);
    }
  }

 private:
  static constexpr int64_t kGroup = 64;  ///< buckets of a group; whole vectors of the kernels

  const KdTree::Node& node(int64_t b) const { return tree_.nodes[tree_.leaves[b]]; }

  bool precedes(int64_t a, int64_t b) const {
    const float reach_a = bucket_.reach[a], reach_b = bucket_.reach[b];
    return reach_a > reach_b || (reach_a == reach_b && row_[a] < row_[b]);
  }

  void relax(int64_t b, const float* point) {
    const int64_t begin = node(b).begin;
    int64_t first = 0;
    bucket_.reach[b] =
        kernels_.relax(tree_.x.data() + begin, tree_.y.data() + begin, tree_.z.data() + begin,
                       node(b).end - begin, point, distance_.data() + begin, &first);
    farthest_[b] = begin + first;
    row_[b] = tree_.index[farthest_[b]];
  }

  void find_leader(int64_t g) {
    const int64_t end = std::min(count_, (g + 1) * kGroup);
    int64_t best = g * kGroup;
    for (int64_t b = best + 1; b < end; ++b) {
      if (precedes(b, best)) best = b;
    }
    leader_[g] = best;
    group_.reach[g] = bucket_.reach[best];
  }

  const KdTree& tree_;
  const PointKernels& kernels_;
  int64_t count_, groups_;
  Boxes bucket_, group_;
  std::vector<int64_t> farthest_;  ///< of each bucket: position of the point at its reach
  std::vector<int32_t> row_;       ///< and its row
  std::vector<int64_t> leader_;    ///< of each group: the bucket that reaches farthest
  std::vector<int32_t> reached_groups_, reached_buckets_;
  std::vector<float> distance_;  ///< of every position to the picks so far
};

std::tuple<at::Tensor, at::Tensor> farthest_point_sampling_cpu(const at::Tensor& points,
                                                               int64_t count) {
  check_farthest_point_args(points, count);
  at::Tensor index = at::empty({count}, points.options().dtype(at::kLong));
  at::Tensor distance = at::empty({count}, points.options());
  if (count == 0) return {index, distance};
  const KdTree tree(points.const_data_ptr<float>(), points.size(0), kBucketSize);
  Sampler sampler(tree);
  auto* out_index = index.data_ptr<int64_t>();
  auto* out_distance = distance.data_ptr<float>();
  // All distances are infinite at first, so the lowest row, 0, is the first pick.
  for (int64_t i = 0; i < count; ++i) {
    const int64_t b = sampler.farthest_bucket();
    out_index[i] = sampler.row(b);
    out_distance[i] = sampler.reach(b);
    sampler.pick(b);
  }
  return {index, distance};
}

std::tuple<std::vector<at::Tensor>, std::vector<at::Tensor>> farthest_point_sampling_of_sets_cpu(
    at::TensorList sets, at::IntArrayRef counts) {
  check_farthest_point_sets(sets, counts);
  std::vector<at::Tensor> picks(sets.size()), insertions(sets.size());
  for (size_t i = 0; i < sets.size(); ++i)
    std::tie(picks[i], insertions[i]) = farthest_point_sampling_cpu(sets[i], counts[i]);
  return {picks, insertions};
}

}  // namespace
}  // namespace lte::ops

TORCH_LIBRARY_IMPL(lte, CPU, m) {
  m.impl("farthest_point_sampling", lte::ops::farthest_point_sampling_cpu);
  m.impl("farthest_point_sampling_of_sets", lte::ops::farthest_point_sampling_of_sets_cpu);
}
