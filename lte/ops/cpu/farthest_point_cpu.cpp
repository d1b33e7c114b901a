// Farthest point sampling on the CPU: exact, but a pick only visits the buckets of points it can
// come nearer to.
#include <limits>
#include <vector>

#include <ATen/ops/empty.h>
#include <torch/library.h>

#include "lte/ops/arguments.h"
#include "lte/ops/cpu/kd_tree.h"
#include "lte/ops/cpu/kernels.h"

namespace lte::ops {
namespace {

constexpr int kBucketSize = 64;
constexpr float kPicked = -1;  ///< below every distance: a point is picked once

class Sampler {
 public:
  explicit Sampler(const KdTree& tree)
      : tree_(tree),
        kernels_(point_kernels()),
        count_(static_cast<int64_t>(tree.leaves.size())),
        stride_(count_ + KdTree::kPadding),
        box_(6 * stride_),
        reach_(stride_, kPicked),
        farthest_(count_),
        row_(count_),
        visit_(stride_ + KdTree::kPadding),
        distance_(tree.index.size() + KdTree::kPadding, std::numeric_limits<float>::infinity()) {
    for (int64_t b = 0; b < count_; ++b) {
      const KdTree::Node& node = bucket(b);
      for (int axis = 0; axis < 3; ++axis) {
        box_[axis * stride_ + b] = node.low[axis];
        box_[(axis + 3) * stride_ + b] = node.high[axis];
      }
      reach_[b] = std::numeric_limits<float>::infinity();
      farthest_[b] = node.begin;
      row_[b] = tree_.index[node.begin];
    }
  }

  /// The bucket whose farthest point is the farthest of all; by row among equals.
  int64_t farthest_bucket() const {
    int64_t best = 0;
    for (int64_t b = 1; b < count_; ++b) {
      if (reach_[b] > reach_[best] || (reach_[b] == reach_[best] && row_[b] < row_[best])) best = b;
    }
    return best;
  }

  float reach(int64_t b) const { return reach_[b]; }
  int32_t row(int64_t b) const { return row_[b]; }

  /// Picks the farthest point of a bucket.
  void pick(int64_t picked) {
    const int64_t position = farthest_[picked];
    const float point[3] = {tree_.x[position], tree_.y[position], tree_.z[position]};
    distance_[position] = kPicked;
    // Visits the pick's own bucket even if all else in it coincides with the pick.
    reach_[picked] = std::numeric_limits<float>::infinity();
    // A bucket with nothing farther than the distance of its box cannot change.
    const int64_t visits =
        kernels_.reached(box_.data(), stride_, count_, point, reach_.data(), visit_.data());
    for (int64_t i = 0; i < visits; ++i) {
      const int64_t b = visit_[i], begin = bucket(b).begin;
      int64_t first = 0;
      reach_[b] =
          kernels_.relax(tree_.x.data() + begin, tree_.y.data() + begin, tree_.z.data() + begin,
                         bucket(b).end - begin, point, distance_.data() + begin, &first);
      farthest_[b] = begin + first;
      row_[b] = tree_.index[farthest_[b]];
    }
  }

 private:
  const KdTree::Node& bucket(int64_t b) const { return tree_.nodes[tree_.leaves[b]]; }

  const KdTree& tree_;
  const PointKernels& kernels_;
  int64_t count_, stride_;
  std::vector<float> box_, reach_;  ///< bounds of the buckets; largest distance in each
  std::vector<int64_t> farthest_;   ///< position of the point at that distance
  std::vector<int32_t> row_;        ///< and its row
  std::vector<int32_t> visit_;
  std::vector<float> distance_;  ///< of every position to the picks so far
};

std::tuple<at::Tensor, at::Tensor> farthest_point_sampling_cpu(const at::Tensor& points,
                                                               int64_t count) {
  const char* op = "farthest_point_sampling";
  check_triples(points, at::kFloat, op, "points");
  TORCH_CHECK(count >= 0 && count <= points.size(0), op, ": count must be 0 to ", points.size(0),
              ", the number of points, got ", count);
  check_finite_rows(points, op, "points");
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

}  // namespace
}  // namespace lte::ops

TORCH_LIBRARY_IMPL(lte, CPU, m) {
  m.impl("farthest_point_sampling", lte::ops::farthest_point_sampling_cpu);
}
