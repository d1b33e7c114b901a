// Where somebody could stand in the rooms of a scene. Cameras stand there, and lights hang there.
#pragma once

#include <cstdint>
#include <vector>

#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/placement/free_space.h"

namespace lte::pathtrace {

/// What is around a place, from worst to best.
enum class Surroundings {
  Open,          ///< or inside a solid, or too near a surface
  BetweenWalls,  ///< in a scene where nothing has a ceiling
  Enclosed,      ///< most directions meet something
  Indoors,       ///< under a ceiling and between walls
};

struct RoomPlace {
  Vec3 eye;  ///< 1.2 to 1.7 units above a floor
  Surroundings surroundings = Surroundings::Open;
  float free_distance = 0;  ///< geometric mean of the distances around it
  bool sees_sky = false;
};

/// Places of the best kind that the scene has, at random. None where `space` has no rooms, and none
/// in what is lower than a room, unless it is closed all round.
/// @param enough  stops looking after so many indoors; there may be a few more
std::vector<RoomPlace> find_room_places(const Bvh& bvh, const FreeSpace& space, uint64_t seed,
                                        int enough);

}  // namespace lte::pathtrace
