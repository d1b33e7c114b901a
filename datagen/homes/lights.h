// Ceiling lights: rectangles flush with the ceiling, at least kLightWallDistance from walls (the
// paper's supplement, lighting heuristics), and spots. Furniture that is placed later keeps clear
// of them.
#pragma once

#include "datagen/homes/stage.h"

namespace lte::datagen::homes {

/// Places one or two lights in each room. Most of them are on, and at least one in the home is.
/// @param daylight  windows shine: fewer lights are on
void place_ceiling_lights(Stage* stage, Kit* kit, bool daylight);

}  // namespace lte::datagen::homes
