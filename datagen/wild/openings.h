// Openings between cells and to the outside, from a slit to a whole missing wall.
#pragma once

#include "datagen/wild/plan.h"

namespace lte::datagen::wild {

/// Cuts the openings of all links, then windows and missing walls. A sheet between two cells is the
/// wall of the first: the second lacks its own there.
/// @param sky  more windows
void cut_openings(bool sky, Plan* plan, Dice* dice);

}  // namespace lte::datagen::wild
