// A wall as a grid through the edges of its openings, so that no vertex lies on another
// rectangle's edge.
#pragma once

#include <array>
#include <vector>

#include "datagen/homes/floor_plan.h"

namespace lte::datagen::homes {

/// A closed rectangle of a wall: from a0 to a1 along it, from y0 to y1 up.
struct WallCell {
  float a0, a1, y0, y1;
};

/// The cells that no opening on `side` takes, along the wall first and then up.
std::vector<WallCell> wall_cells(const std::vector<Opening>& openings, Side side,
                                 const std::array<float, 2>& along, const std::array<float, 2>& up);

}  // namespace lte::datagen::homes
