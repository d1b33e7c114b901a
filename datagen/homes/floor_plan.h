// Floor plans: a rectangle split recursively into rooms, with doorways along a graph that reaches
// every room, an entrance, and windows in the outer walls. Metres, seen from above: x and z.
#pragma once

#include <cstdint>
#include <vector>

#include "lte/base/math.h"
#include "lte/base/random.h"

namespace lte::datagen::homes {

/// What a room is for. Corridors join the rooms of homes of four rooms and more.
enum class RoomType { Bedroom, Living, Kitchen, Bathroom, Study, Dining, Corridor };
inline constexpr int kRoomTypes = 7;
const char* room_name(RoomType type);

struct Rect {
  float x0 = 0, z0 = 0, x1 = 0, z1 = 0;
  float width() const { return x1 - x0; }
  float depth() const { return z1 - z0; }
  float area() const { return width() * depth(); }
};

/// Walls of a room by the direction that leads out through them.
enum class Side { NegX, PosX, NegZ, PosZ };
inline constexpr Side kSides[] = {Side::NegX, Side::PosX, Side::NegZ, Side::PosZ};
inline bool along_z(Side side) { return side == Side::NegX || side == Side::PosX; }
Side opposite(Side side);

enum class OpeningKind { Doorway, Entrance, Window };

/// A hole in a wall of `room`. A doorway is also a hole in the wall of `other`.
struct Opening {
  OpeningKind kind = OpeningKind::Doorway;
  int room = 0, other = -1;
  Side side = Side::NegX;     ///< which wall of `room`; in `other` it is the opposite one
  float from = 0, to = 0;     ///< extent along the wall: z or x
  float bottom = 0, top = 0;  ///< y
  float depth = 0;            ///< thickness of the wall that it goes through
};

struct PlanRoom {
  RoomType type = RoomType::Living;
  Rect inner;  ///< between the faces of its walls
};

struct FloorPlan {
  std::vector<PlanRoom> rooms;
  std::vector<Opening> openings;
  float height = 2.6f;  ///< of all ceilings
  float wall = 0.12f;   ///< thickness of inner walls

  /// A wall's plane: x or z of the face of room `room`.
  float face(int room, Side side) const;
  /// Openings of one room, each seen from that room.
  std::vector<Opening> openings_of(int room) const;
};

inline constexpr float kMaxHomeExtent = 15.5f;  ///< of a home along x and z, recesses included
/// The sphere around a home of any size, on which its sun stands: its diameter.
inline constexpr float kMaxHomeSphere = 22.4f;
/// Homes of no more rooms have spheres within kMaxHomeExtent.
inline constexpr int kMaxRoomsOfSmallHomes = 2;
inline constexpr float kRecess = 0.16f;  ///< of windows and the entrance into outer walls

/// Draws a floor plan.
/// @param rooms  1 to 6, including the corridor, which homes of four rooms and more have
/// @throws lte::Error if many attempts give no plan whose rooms are all usable and reachable.
FloorPlan make_floor_plan(int rooms, float height, Rng* rng);

}  // namespace lte::datagen::homes
