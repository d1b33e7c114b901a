// Points on surfaces, each with a radius, by the places that they speak for.
//
// A uniform grid of cells, hashed, and within a cell six bins by the axis that a normal is nearest
// to. A point is listed in every cell that its disc touches, under every axis that an accepted
// normal may belong to, so that a look-up reads one list.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "lte/base/math.h"
#include "lte/gi/surface_lanes.h"

namespace lte::gi {

/// Thread-safe; keeps no reference.
class SurfaceIndex {
 public:
  /// Least cosine between the normals of a point and a place that it speaks for: 37 degrees. The
  /// other side of a wall never counts.
  static constexpr float kMinCosine = 0.8f;
  /// How far off each other's tangent plane they may be, in radii.
  static constexpr float kPlane = 0.2f;

  SurfaceIndex() = default;

  /// @param normals  unit; of the side that the point stands on
  /// @param radii    metres, how far the point speaks for its surroundings; those above 8 times the
  ///                 mean are cut to that
  /// @param cell_edge  edge of a cell in mean radii: smaller ones take memory and shorten lists
  /// @throws lte::Error if sizes differ, or a value is not finite or a radius not positive.
  SurfaceIndex(std::span<const Vec3> positions, std::span<const Vec3> normals,
               std::span<const float> radii, float cell_edge = 1);

  /// Lays out every list as look-ups read it: they are quicker, and a point takes 32 bytes a list
  /// that it stands in instead of 4.
  void pack();

  int64_t size() const { return static_cast<int64_t>(points_.size()); }

  /// Calls use(point, weight, offset) for all points that speak for `position` on the side
  /// `normal`, in their order. The weight, in (0, 1], falls smoothly to 0 with distance, distance
  /// off the plane and angle of normals; `offset` leads from the point to the position.
  template <typename Use>
  void for_each(const Vec3& position, const Vec3& normal, const Use& use) const {
    const Cell* cell = find(position, normal);
    if (cell == nullptr) return;
    if (!lanes_.empty()) return for_each_packed(*cell, position, normal, use);
    for (uint32_t k = cell->begin; k < cell->end; ++k) {
      const uint32_t index = listed_[k];
      const Point& point = points_[index];
      const Vec3 offset = position - point.position;
      const float far = dot(offset, offset) * point.inverse_radius2;
      const float cosine = dot(normal, point.normal);
      if (!(far < 1) || !(cosine > kMinCosine)) continue;
      const float off =
          std::max(std::fabs(dot(offset, point.normal)), std::fabs(dot(offset, normal)));
      const float off2 = off * off * point.inverse_radius2 * (1 / (kPlane * kPlane));
      if (!(off2 < 1)) continue;
      const float near = 1 - far;
      const float turned = (cosine - kMinCosine) * (1 / (1 - kMinCosine));
      use(index, near * near * (1 - off2) * turned, offset);
    }
  }

 private:
  static constexpr uint32_t kAtOnce = 8;  ///< blocks of lanes that are weighed in one go

  struct Point {
    Vec3 position;
    float inverse_radius2;
    Vec3 normal;
    float radius;
  };
  struct Cell {
    uint64_t key = kEmpty;
    uint32_t begin = 0, end = 0;  ///< of listed_, or of lanes_
  };
  static constexpr uint64_t kEmpty = ~uint64_t{0};
  static constexpr int64_t kCells = int64_t{1} << 20;  ///< along each axis at most

  template <typename Use>
  void for_each_packed(const Cell& cell, const Vec3& position, const Vec3& normal,
                       const Use& use) const {
    for (uint32_t first = cell.begin; first < cell.end; first += kAtOnce) {
      const auto blocks = static_cast<int>(std::min(kAtOnce, cell.end - first));
      alignas(64) float weights[kAtOnce * SurfaceLanes::kLanes];
      int speaking[kAtOnce * SurfaceLanes::kLanes], count = 0;
      weigh_lanes(lanes_.data() + first, blocks, position, normal, weights);
      for (int i = 0; i < blocks * SurfaceLanes::kLanes; ++i) {  // without a branch to guess
        speaking[count] = i;
        count += weights[i] > 0 ? 1 : 0;
      }
      for (int k = 0; k < count; ++k) {
        const SurfaceLanes& block =
            lanes_[first + static_cast<uint32_t>(speaking[k] / SurfaceLanes::kLanes)];
        const int lane = speaking[k] % SurfaceLanes::kLanes;
        use(block.point[lane], weights[speaking[k]], position - block.position(lane));
      }
    }
  }

  const Cell* find(const Vec3& position, const Vec3& normal) const;
  Cell& slot(uint64_t key);
  /// Calls use(key) for every list that the point belongs to.
  template <typename Use>
  void for_each_list(const Point& point, const Use& use) const;

  std::vector<Point> points_;
  std::vector<uint32_t> listed_;
  std::vector<SurfaceLanes> lanes_;  ///< in its place, once packed
  std::vector<Cell> cells_;          ///< open addressing; a power of two
  Vec3 low_;
  float inverse_edge_ = 1;
};

}  // namespace lte::gi
