#include "lte/ops/cpu/search/kd_tree.h"

#include <algorithm>
#include <numeric>

namespace lte::ops {
namespace {

void fit_bounds(KdTree::Node& node, const float* points, const std::vector<int32_t>& index) {
  for (int axis = 0; axis < 3; ++axis) {
    node.low[axis] = std::numeric_limits<float>::infinity();
    node.high[axis] = -std::numeric_limits<float>::infinity();
  }
  for (int32_t i = node.begin; i < node.end; ++i) {
    const float* p = points + 3 * static_cast<int64_t>(index[i]);
    for (int axis = 0; axis < 3; ++axis) {
      node.low[axis] = std::min(node.low[axis], p[axis]);
      node.high[axis] = std::max(node.high[axis], p[axis]);
    }
  }
}

/// Where to cut: near the middle, on a multiple of the leaf size, and never between equal
/// coordinates, so that `split` sends every point to its own side.
int32_t partition(const KdTree::Node& node, const float* points, std::vector<int32_t>& index,
                  int leaf_size, int axis) {
  const auto coordinate = [&](int32_t row) { return points[3 * static_cast<int64_t>(row) + axis]; };
  const int32_t count = node.end - node.begin;
  const int32_t half = std::max(1, (count / 2 + leaf_size / 2) / leaf_size) * leaf_size;
  const auto first = index.begin() + node.begin, last = index.begin() + node.end;
  auto middle = first + std::min(half, count - 1);
  std::nth_element(first, middle, last,
                   [&](int32_t a, int32_t b) { return coordinate(a) < coordinate(b); });
  const float value = coordinate(*middle);
  // Equal coordinates go right, or, where nothing would stay left, left.
  middle = std::partition(first, middle, [&](int32_t row) { return coordinate(row) < value; });
  if (middle == first) {
    middle = std::partition(first, last, [&](int32_t row) { return coordinate(row) <= value; });
  }
  return static_cast<int32_t>(middle - index.begin());
}

}  // namespace

KdTree::KdTree(const float* points, int64_t count, int leaf_size, int64_t max_coincident) {
  index.resize(count);
  std::iota(index.begin(), index.end(), 0);
  if (count > 0) nodes.push_back({{}, {}, 0, static_cast<int32_t>(count), -1, -1, 0, 0});
  std::vector<int32_t> stack(count > 0 ? 1 : 0, 0);
  while (!stack.empty()) {
    const int32_t id = stack.back();
    stack.pop_back();
    Node& node = nodes[id];
    fit_bounds(node, points, index);
    int axis = -1;
    for (int a = 0; a < 3; ++a) {
      // Halved, as the extent of two finite numbers may overflow.
      const auto extent = [&](int i) { return node.high[i] / 2 - node.low[i] / 2; };
      if (node.low[a] < node.high[a] && (axis < 0 || extent(a) > extent(axis))) axis = a;
    }
    const bool coincident = axis < 0;
    if (coincident || node.end - node.begin <= leaf_size) {
      std::sort(index.begin() + node.begin, index.begin() + node.end);
      if (coincident && node.end - node.begin > max_coincident) {
        node.end = static_cast<int32_t>(node.begin + max_coincident);
      }
      leaves.push_back(id);
      continue;
    }
    const int32_t middle = partition(node, points, index, leaf_size, axis);
    float split = std::numeric_limits<float>::infinity();
    for (int32_t i = middle; i < node.end; ++i) {
      split = std::min(split, points[3 * static_cast<int64_t>(index[i]) + axis]);
    }
    const auto left = static_cast<int32_t>(nodes.size());
    const Node low{{}, {}, node.begin, middle, id, -1, 0, 0};
    const Node high{{}, {}, middle, node.end, id, -1, 0, 0};
    node.axis = axis;
    node.split = split;
    node.left = left;
    nodes.push_back(low);
    nodes.push_back(high);
    stack.push_back(left + 1);  // the left child next, so that leaves come in order
    stack.push_back(left);
  }
  x.assign(count + kPadding, 0.0f);
  y = x;
  z = x;
  for (int64_t i = 0; i < count; ++i) {
    const float* p = points + 3 * static_cast<int64_t>(index[i]);
    x[i] = p[0];
    y[i] = p[1];
    z[i] = p[2];
  }
}

}  // namespace lte::ops
