// Triangles that stand where another one stands already.
#pragma once

#include <cstdint>
#include <vector>

#include "lte/scene/scene.h"

namespace lte::scene {

/// Marks triangles that have the corners, to the bit, and the winding of one before. Rays meet one
/// of them, so points drawn by area must not count the others. Emitters are never marked: each of
/// them is a light of its own.
class RepeatedTriangles {
 public:
  /// O(number of instanced triangles), most of it in parallel; some 6 bytes of memory for each.
  explicit RepeatedTriangles(const Scene& scene);

  int64_t count() const { return count_; }
  bool contains(int instance, uint32_t triangle) const {
    return count_ > 0 && marks_[first_[static_cast<size_t>(instance)] + triangle];
  }

 private:
  std::vector<size_t> first_;  ///< index of each instance's first triangle
  std::vector<bool> marks_;
  int64_t count_ = 0;
};

}  // namespace lte::scene
