// What the empty space of a scene looks like: how high its rooms are, on which sides it is open,
// how much of it is rooms. The automatic camera, its turntable and added lights all ask here.
#pragma once

#include <array>

#include "lte/pathtrace/bvh.h"

namespace lte::pathtrace {

struct FreeSpace {
  /// Median height between a level floor and a level ceiling, in units of the file; 0 where less
  /// than a twentieth of the bounding box has both above each other.
  float room_height = 0;
  /// Share of points in the bounding box from which a ray along −x, +x, −y, +y, −z or +z leaves the
  /// scene.
  std::array<float, 6> open{};
  /// Share of front faces in what is seen from outside: 1 for objects and whole houses, 0 for a
  /// room that is nothing but its inner side.
  float outward = 0;
  /// What counts as a metre at eye height. Scenes lower than a room are taken for scale models,
  /// and rooms of more than 60 units are not in metres.
  float unit = 1;
  /// Share of what has a roof where a person could stand under it: a level floor, 1.8 units of
  /// height or more, 0.3 of free space all round, walls. Half for a furnished house. The hollow
  /// parts of a machine are not so.
  float standing = 0;

  float below() const { return open[2]; }
  float above() const { return open[3]; }
  /// Whether the floor and three of the four sides or more are closed from nearly everywhere.
  bool surrounded() const;
  /// Whether all six sides are.
  bool closed() const;
  /// Whether those outside see front faces, as of objects and whole houses.
  bool shows_outside() const { return outward > 0.5f; }
  /// Whether its hollows are rooms. What shows no outside is nothing but rooms; what does needs
  /// places to stand.
  bool has_rooms() const;
};

/// Shares above kOpen are an open side, below kClosed a closed one. Furniture stops rays on their
/// way out of an open side, and a room's windows let some out of a closed one.
inline constexpr float kOpen = 0.6f, kClosed = 0.15f;

/// Places in rooms, as those who stand there see them: directions looked in; the share of them that
/// must meet something, as a room may lack one wall; and the share of these that must be fronts, as
/// inside a solid there are none.
inline constexpr int kProbes = 48;
inline constexpr float kEnclosed = 0.7f, kFronts = 0.1f;

/// Units: rooms are not lower.
inline constexpr float kLowestRoom = 1.8f;
/// Share of what has a roof: less is no house. A machine has 0.03, a house on its side 0.26.
inline constexpr float kStanding = 0.1f;

/// Evenly spread over the sphere (a Fibonacci lattice). @param i  0 to kProbes - 1, from the top
Vec3 probe_direction(int i);

/// Whether a place is in a room, or in another hollow: kEnclosed of the directions meet something,
/// and not all of it from behind.
bool is_enclosed(const Bvh& bvh, const Vec3& place);

/// Looks at a few hundred points of the bounding box. Deterministic.
FreeSpace survey(const Bvh& bvh);

/// The unit that rooms of this height must have been modelled in: "centimetres" for 150 to 1,500,
/// "millimetres" for 1,500 to 15,000, and null for all else. No ceiling is 150 m high, and few are
/// lower than 1.5 m.
const char* likely_unit(float room_height);

}  // namespace lte::pathtrace
