// Where a person can walk: free cells of a grid, and whether they connect.
#pragma once

#include <vector>

#include "datagen/homes/floor_plan.h"
#include "datagen/homes/piece.h"

namespace lte::datagen::homes {

inline constexpr float kWalkRadius = 0.24f;  ///< half the width of a person, metres
inline constexpr float kWalkCell = 0.07f;    ///< metres

/// The free cells of one room, whose middles are `kWalkRadius` away from walls and things.
class WalkGrid {
 public:
  explicit WalkGrid(const Rect& room);

  /// Blocks the cells near `box`, unless it hangs above heads or lies flat on the floor.
  void block(const OrientedBox& box);
  bool is_free(const Vec2& at) const;

  /// Whether every point of `doors` can be walked to from the first one.
  bool connects(const std::vector<Vec2>& doors) const;
  /// Middles of the cells that can be walked to from `start`.
  std::vector<Vec2> reachable(const Vec2& start) const;

 private:
  int index(const Vec2& at) const;  ///< −1 outside
  Vec2 middle(int cell) const;
  std::vector<int> flood(int start) const;

  Rect room_;
  int columns_, rows_;
  std::vector<char> free_;
};

/// The point just inside the middle of each door of a room.
std::vector<Vec2> door_steps(const FloorPlan& plan, int room);

}  // namespace lte::datagen::homes
