// Internal: which places lie near a point, and may see it.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "lte/pathtrace/reach/light_finder.h"

namespace lte::pathtrace {

/// Some places by the cubic cells that they lie in, found again by hashing.
class PlaceGrid {
 public:
  /// @param places   to be kept alive
  /// @param members  numbers of those that the grid has
  /// @param radius   of a search
  PlaceGrid(const std::vector<Place>& places, std::span<const uint32_t> members, float radius);

  /// Calls `use(number)` for places within the radius of a vertex that lie on its side and have it
  /// on theirs, in an order that depends on the grid alone, until it returns true.
  /// @return whether it did
  template <typename Use>
  bool any_before(const PathVertex& vertex, const Use& use) const {
    for (const uint64_t key : cells_around(vertex.position)) {
      const Cell cell = find(key);
      for (uint32_t k = cell.begin; k < cell.end; ++k)
        if (face_each_other(vertex, entries_[k]) && use(entries_[k].number)) return true;
    }
    return false;
  }

 private:
  struct Entry {
    Vec3 position, side;
    uint32_t number;
  };
  struct Cell {
    uint64_t key = 0;
    uint32_t begin = 0, end = 0;  ///< into entries_; equal: an empty slot
  };

  /// The eight cells that a ball of the radius around a point can reach into.
  std::array<uint64_t, 8> cells_around(const Vec3& point) const;
  Cell find(uint64_t key) const;
  bool face_each_other(const PathVertex& vertex, const Entry& entry) const;

  const float radius_;
  std::vector<Entry> entries_;  ///< cell by cell
  std::vector<Cell> slots_;     ///< open addressing
};

}  // namespace lte::pathtrace
