// Edges and shells (surfaces connected through edges): what is open, branching or wound the wrong
// way round.
#pragma once

#include <vector>

#include "lte/scene/inspect/inspect.h"
#include "lte/scene/inspect/topology.h"

namespace lte::scene {

/// Fills the counts of edges and shells.
/// @param covered  triangles that do not count: without area, or standing where another one stands
void count_shells(const WorldTopology& topology, const std::vector<bool>& covered,
                  GeometryFaults* report);

}  // namespace lte::scene
