// A k-d tree over points, its leaves stored as contiguous coordinate arrays for the vector kernels.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

namespace lte::ops {

struct KdTree {
  struct Node {
    float low[3], high[3];  ///< tight bounds
    int32_t begin, end;     ///< its points, contiguous in the arrays below
    int32_t parent;         ///< -1 for the root
    int32_t left;           ///< children left and left + 1; -1 for a leaf
    int32_t axis;
    float split;  ///< a point with coordinate[axis] < split belongs to the left child
  };

  std::vector<Node> nodes;      ///< nodes[0] is the root; empty without points
  std::vector<int32_t> leaves;  ///< node numbers in the order of their points
  std::vector<float> x, y, z;   ///< coordinates in leaf order, and kPadding more that may be read
  std::vector<int32_t> index;   ///< original row of each; ascending inside a leaf

  static constexpr int kPadding = 16;

  /// Median splits of the widest axis; all leaves but the last of a subtree hold `leaf_size`
  /// points. Points that coincide are not split: such a leaf may be larger, and keeps its
  /// `max_coincident` lowest rows only.
  ///
  /// @param points  [count, 3], finite
  KdTree(const float* points, int64_t count, int leaf_size,
         int64_t max_coincident = std::numeric_limits<int64_t>::max());

  int32_t find_leaf(const float* point) const {
    int32_t node = 0;
    while (nodes[node].left >= 0) {
      node = nodes[node].left + (point[nodes[node].axis] < nodes[node].split ? 0 : 1);
    }
    return node;
  }
};

}  // namespace lte::ops
