// Where to stand to look at a room.
#pragma once

#include "datagen/homes/home.h"

namespace lte::datagen::homes {

/// Places one camera in each room, at eye height where a person can stand, looking at what is in
/// the room. The largest room comes first. Rooms where nobody can stand have no camera.
std::vector<scene::Camera> room_cameras(const HomePlan& plan);

}  // namespace lte::datagen::homes
