// Which places lie so near a small lamp that light there is finer than the records of a cache.
#pragma once

#include <cstdint>
#include <vector>

#include "lte/base/math.h"
#include "lte/scene/scene.h"

namespace lte::gi {

/// Below a lamp at a distance d its light falls off over a length of some d. Records that stand
/// farther apart miss it or meet it by chance, and those that have missed it agree with each other:
/// nothing in them tells that there is anything to miss. What a lamp brings to the other surfaces
/// by way of such a place, as out of a cup that it stands in, is lost with it.
///
/// Luminaires that are longer than the reach are left out, as tubes are: records meet what they
/// light. Thread-safe.
class NearLamps {
 public:
  NearLamps() = default;
  /// Point and spot lights, and emissive instances that are no longer than the reach.
  /// @param reach  metres, positive: nearer places than this count as near
  NearLamps(const scene::Scene& scene, float reach);

  /// Whether a lamp stands near, above the side `normal` of the surface at `position`, and shines
  /// that way.
  bool above(const Vec3& position, const Vec3& normal) const {
    return !lamps_.empty() && marked(key_of(cell_of(position))) && finds_above(position, normal);
  }

 private:
  struct Lamp {
    Vec3 position;
    Vec3 axis;     ///< the way that it shines; zero for all around
    uint64_t key;  ///< of the cell whose places it may be near
  };
  struct Cell {
    int64_t x, y, z;
  };

  void add(const Vec3& position, const Vec3& axis);
  Cell cell_of(const Vec3& position) const;
  static uint64_t key_of(const Cell& cell);
  bool marked(uint64_t key) const { return (marks_[key >> 6 & kWords] >> (key & 63) & 1) != 0; }
  bool finds_above(const Vec3& position, const Vec3& normal) const;

  static constexpr uint64_t kWords = 1023;  ///< a power of two, less 1
  float reach_ = 0;
  std::vector<Lamp> lamps_;      ///< by key, each in all cells around its own
  std::vector<uint64_t> marks_;  ///< a bit a key, by its low bits: most places are near none
};

}  // namespace lte::gi
