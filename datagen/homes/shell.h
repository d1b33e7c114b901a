// The building itself: floors, walls, ceilings, skirting, door frames, windows, ceiling lights.
#pragma once

#include "datagen/homes/stage.h"

namespace lte::datagen::homes {

/// Builds floors, ceilings and walls with their holes, and skirting along them.
void build_shell(Stage* stage, Kit* kit);

enum class Windows {
  Panes,  ///< that shine, or are dark; no light comes in from outside
  Open,   ///< for what shines outside
};

/// Builds reveals and frames of doorways, the leaf of the entrance, and windows with panes, frames
/// and sills.
/// @param daylight  radiance of the panes; 0 for dark ones
void build_openings(Stage* stage, Kit* kit, Windows windows, const Rgb& daylight);

}  // namespace lte::datagen::homes
