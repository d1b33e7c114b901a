// Where to stand to look at a room.
#pragma once

#include "datagen/homes/home.h"

namespace lte::datagen::homes {

/// One camera a room, at eye height where a person can stand, towards what is in the room; the
/// largest room first. Rooms where nobody can stand have none.
std::vector<scene::Camera> room_cameras(const HomePlan& plan);

}  // namespace lte::datagen::homes
