// Internal: sums of light by group and slot, for incident.h.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/ray_offset.h"
#include "lte/pathtrace/transport/transport.h"

namespace lte::pathtrace {

/// Adds up what paths bring, by group and slot.
class SlotSums : public LightSink {
 public:
  struct Sum {
    double x = 0, y = 0, z = 0;
  };

  SlotSums(int64_t groups, int64_t slots)
      : slots_(static_cast<size_t>(slots)),
        direct_(static_cast<size_t>(groups) * slots_),
        indirect_(direct_.size()) {}

  void clear() {
    std::fill(direct_.begin(), direct_.end(), Sum{});
    std::fill(indirect_.begin(), indirect_.end(), Sum{});
  }
  /// Sets the slot of a path of the block that is traced next.
  void assign(int path, int64_t slot) {
    slot_of_path_[static_cast<size_t>(path)] = static_cast<size_t>(slot);
  }
  void add(int depth, std::span<const Contribution> contributions) override {
    std::vector<Sum>& sums = depth == 1 ? direct_ : indirect_;
    for (const Contribution& c : contributions) {
      Sum& sum = sums[static_cast<size_t>(c.light_group) * slots_ +
                      slot_of_path_[static_cast<size_t>(c.path)]];
      sum.x += c.value.x;
      sum.y += c.value.y;
      sum.z += c.value.z;
    }
  }
  /// Writes the means over `count` paths of all slots of a group.
  void store(int64_t group, int count, Rgb* direct, Rgb* indirect) const {
    const size_t first = static_cast<size_t>(group) * slots_;
    const auto mean = [count](const Sum& s) {
      return Rgb{static_cast<float>(s.x / count), static_cast<float>(s.y / count),
                 static_cast<float>(s.z / count)};
    };
    std::transform(direct_.begin() + first, direct_.begin() + first + slots_, direct, mean);
    std::transform(indirect_.begin() + first, indirect_.begin() + first + slots_, indirect, mean);
  }

 private:
  size_t slots_;
  std::vector<Sum> direct_, indirect_;
  std::array<size_t, kBlock> slot_of_path_{};
};

/// Where paths start, in the frame of the BVH.
inline Vec3 off_surface(const Bvh& bvh, const Vec3& position, const Vec3& normal) {
  const float half_extent = 0.5f * max_component(bvh.bounds().extent());
  return offset_origin(position, normal, half_extent) - bvh.handles().origin;
}

}  // namespace lte::pathtrace
