#include "lte/ops/cpu/search/box_levels.h"

#include <algorithm>
#include <limits>

namespace lte::ops {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// `count` boxes around nothing.
std::vector<float> empty_boxes(int64_t count, int64_t stride) {
  std::vector<float> box(static_cast<size_t>(6 * stride), kInfinity);
  for (int64_t axis = 3; axis < 6; ++axis) {
    const auto high = box.begin() + axis * stride;
    std::fill(high, high + count, -kInfinity);
  }
  return box;
}

}  // namespace

BoxLevels::BoxLevels(const KdTree& tree) {
  const auto leaves = static_cast<int64_t>(tree.leaves.size());
  int64_t stride = leaves + KdTree::kPadding;
  levels_.push_back(empty_boxes(leaves, stride));
  for (int64_t i = 0; i < leaves; ++i) {
    const KdTree::Node& node = tree.nodes[tree.leaves[i]];
    begin_.push_back(node.begin);
    end_.push_back(node.end);
    for (int64_t axis = 0; axis < 3; ++axis) {
      levels_[0][axis * stride + i] = node.low[axis];
      levels_[0][(axis + 3) * stride + i] = node.high[axis];
    }
  }
  view_ = {tree.x.data(), tree.y.data(), tree.z.data(), begin_.data(), end_.data(), {}, 1};
  view_.level[0] = {levels_[0].data(), stride, leaves};
  for (int64_t below = leaves; below > PointBoxes::kBoxesOfOne;) {
    const int64_t count = (below + PointBoxes::kBoxesOfOne - 1) / PointBoxes::kBoxesOfOne;
    const int64_t wide = count + KdTree::kPadding;
    std::vector<float> box = empty_boxes(count, wide);
    const std::vector<float>& inner = levels_.back();
    for (int64_t i = 0; i < below; ++i) {
      const int64_t outer = i / PointBoxes::kBoxesOfOne;
      for (int64_t axis = 0; axis < 3; ++axis) {
        float& low = box[axis * wide + outer];
        float& high = box[(axis + 3) * wide + outer];
        low = std::min(low, inner[axis * stride + i]);
        high = std::max(high, inner[(axis + 3) * stride + i]);
      }
    }
    levels_.push_back(std::move(box));
    view_.level[view_.levels++] = {levels_.back().data(), wide, count};
    below = count;
    stride = wide;
  }
}

}  // namespace lte::ops
