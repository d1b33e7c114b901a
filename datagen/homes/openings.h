// Doorways and windows of a floor plan.
#pragma once

#include "datagen/homes/floor_plan.h"

namespace lte::datagen::homes {

/// Cuts doorways along a spanning tree of the rooms that touch, further ones between rooms for
/// living, and an entrance.
/// @return  false if not every room can be reached
bool cut_doors(FloorPlan* plan, Rng* rng);

/// Cuts one or two windows into the outer walls of each room but the corridor.
void cut_windows(FloorPlan* plan, Rng* rng);

}  // namespace lte::datagen::homes
