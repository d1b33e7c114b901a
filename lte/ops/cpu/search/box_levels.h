// Boxes over a k-d tree's leaves, level over level, as the point kernels walk them: sixteen boxes
// are tested at once.
#pragma once

#include <cstdint>
#include <vector>

#include "lte/ops/cpu/kernels/kernels.h"
#include "lte/ops/cpu/search/kd_tree.h"

namespace lte::ops {

class BoxLevels {
 public:
  /// @param tree  of one point at least; it must outlive this
  explicit BoxLevels(const KdTree& tree);
  BoxLevels(const BoxLevels&) = delete;
  BoxLevels& operator=(const BoxLevels&) = delete;

  const PointBoxes& view() const { return view_; }

 private:
  std::vector<int32_t> begin_, end_;        ///< of each leaf
  std::vector<std::vector<float>> levels_;  ///< BoxLevel::box of each
  PointBoxes view_{};
};

}  // namespace lte::ops
