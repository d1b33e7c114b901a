// Doorways and windows of a floor plan.
#pragma once

#include "datagen/homes/floor_plan.h"

namespace lte::datagen::homes {

/// Doorways along a spanning tree of the rooms that touch, further ones between rooms for living,
/// and an entrance. False if not every room can be reached.
bool cut_doors(FloorPlan* plan, Rng* rng);

/// One or two windows a room in its outer walls; corridors have none.
void cut_windows(FloorPlan* plan, Rng* rng);

}  // namespace lte::datagen::homes
