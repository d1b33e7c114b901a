// Ceiling lights: rectangles flush with the ceiling, at least kLightWallDistance from walls (the
// paper's supplement, lighting heuristics); furniture placed later keeps clear of them. And spots.
#pragma once

#include "datagen/homes/stage.h"

namespace lte::datagen::homes {

/// One or two lights a room, most of them on; at least one of the home is.
/// @param daylight  windows shine: fewer lights are on
void place_ceiling_lights(Stage* stage, Kit* kit, bool daylight);

}  // namespace lte::datagen::homes
