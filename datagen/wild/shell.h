// Floors, walls with their openings, and ceilings.
#pragma once

#include "datagen/wild/builder.h"

namespace lte::datagen::wild {

/// Builds all cells of a plan. Walls are single sheets that face inwards; where a wall has a
/// thickness, its openings have sides. Without holes to the outside the whole is closed.
/// @param emitter  material of every surface, for a furnace; kNone for materials of their own
void build_shell(Builder* builder, Dice* dice, int emitter);

/// A wall between the floor and `top` less its holes, in the frame of its edge, y of the world.
Mesh wall_mesh(const Edge& edge, float floor, const std::vector<Vec2>& top,
               const std::vector<Hole>& holes);

/// What fills a hole at the far end of its depth; its front faces inwards.
Mesh pane_mesh(const Edge& edge, const Hole& hole);

}  // namespace lte::datagen::wild
