// What stands around the records of a cache: which speak for a place, and the walls that end what
// they say. It knows no light, so caches of the same records share it.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "lte/base/math.h"
#include "lte/gi/cache_records.h"
#include "lte/gi/near_lamps.h"
#include "lte/gi/surface_index.h"
#include "lte/pathtrace/bvh.h"

namespace lte::gi {

/// Thread-safe; keeps no reference.
class CacheGeometry {
 public:
  CacheGeometry(const pathtrace::Bvh& bvh, const CacheRecords& records);

  int64_t size() const { return static_cast<int64_t>(around_.size()); }
  /// Mean radius of the records, metres; 0 without any.
  float radius() const { return radius_; }
  /// How much a record counts in the mean of those around a place, for how far one sees from it.
  float share(uint32_t record) const { return around_[record].share; }
  /// Whether a small lamp stands so near a place that no records know its light (NearLamps).
  bool near_lamp(const Vec3& position, const Vec3& normal) const {
    return lamps_.above(position, normal);
  }

  /// Calls use(record, weight, offset) for all records that speak for `position` on the side
  /// `normal` of a surface (SurfaceIndex), whether or not a wall stands between.
  template <typename Use>
  void for_each(const Vec3& position, const Vec3& normal, const Use& use) const {
    index_.for_each(position, normal, use);
  }
  /// Whether a wall stands between a record and what lies at `offset` from it.
  bool hidden(uint32_t record, const Vec3& offset) const {
    const uint32_t walls = around_[record].walls;
    return walls != kNone && walls_[walls].hides(offset);
  }

  /// Which records no lit one leads to, from record to record along surfaces: they lie inside of
  /// things and below them, or in the dark.
  /// @param records  those that this was made of
  /// @param lit      [size()]
  /// @return         [size()]
  std::vector<uint8_t> dark_sheets(const CacheRecords& records, std::span<const uint8_t> lit) const;

 private:
  /// What stands on the surface around a record, by octant around its normal: a wall on a floor
  /// ends what the floor on this side of it has to say.
  struct Walls {
    Vec3 normal, tangent, bitangent;
    /// Places beyond the wall have (x, y) · normal > distance. A zero normal stands for no wall.
    struct Plane {
      float x = 0, y = 0, distance = 0;
    };
    std::array<Plane, 8> plane;
    /// How far along the normal, and against it, the next sheet is.
    float above = INFINITY, below = INFINITY;

    bool hides(const Vec3& offset) const;
  };
  static constexpr uint32_t kNone = ~0u;
  struct Around {
    uint32_t walls = kNone;  ///< index into walls_
    float share = 1;
  };
  /// @param open  gets how far one sees from there, in radii, at most 1: the geometric mean of that
  ///              along the surface, over all octants, and of that away from it
  /// @return      whether there are any walls within `radius`
  static bool find_walls(const pathtrace::Bvh& bvh, const Vec3& position, const Vec3& normal,
                         float radius, Walls* walls, float* open);

  NearLamps lamps_;
  SurfaceIndex index_;
  std::vector<Walls> walls_;
  std::vector<Around> around_;  ///< [size()]
  float radius_ = 0;
};

}  // namespace lte::gi
