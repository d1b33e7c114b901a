// Light that earlier views of a scene have found, kept in cells of its surfaces: a further view
// asks again only where it shows what none before has shown.
//
// A cell is a cube whose edge is a power of two of a metre, for one direction of normals. It keeps
// means of unbiased estimates at the places in it, so that they get better with every ray that is
// added, from whatever view.
#pragma once

#include <cstdint>
#include <vector>

#include "lte/base/math.h"

namespace lte::gi {

/// Irradiance as the means of so many rays, W/m².
struct CellLight {
  Rgb direct, indirect;
  float direct_rays = 0, indirect_rays = 0;

  /// The mean of the rays of both.
  void add(const CellLight& other);
};

/// find() may be called by many threads at once; nothing else may run beside it.
class LightCells {
 public:
  /// @param most  cells that are kept; beyond that those that the last views have not shown are
  ///              forgotten. 96 to 192 bytes each.
  explicit LightCells(int64_t most = int64_t{1} << 19);

  /// A view begins. @return  its number, from 0 on
  int begin_view();

  /// What is known of a place, null for nothing: that of its cell, or else of one that is half or a
  /// quarter as wide, as a view from nearer has left it.
  /// @param normal  unit, of the side that is asked about
  /// @param extent  metres that the place stands for: cells are as wide as that, or up to twice
  const CellLight* find(const Vec3& position, const Vec3& normal, float extent) const;
  /// Adds estimates, to what find() gives; without rays it notes that the place was shown.
  void add(const Vec3& position, const Vec3& normal, float extent, const CellLight& light);

  int64_t size() const { return size_; }

 private:
  struct Cell {
    uint64_t key = 0;  ///< 0 for none
    int view = 0;      ///< that has shown it last
    CellLight light;
  };
  size_t slot(uint64_t key) const;
  /// The slot of the widest cell that find() looks at and that is there; else that of the cell
  /// itself, which is empty.
  size_t known_slot(const Vec3& position, const Vec3& normal, float extent) const;
  void rebuild(size_t slots, int oldest_view);

  int64_t most_, size_ = 0;
  int views_ = 0;
  std::vector<Cell> cells_;  ///< open addressing; a power of two
};

}  // namespace lte::gi
