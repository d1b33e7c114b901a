// Ceilings: flat, sloped, gabled, vaulted, tents and domes over convex cells.
#pragma once

#include "datagen/wild/plan.h"

namespace lte::datagen::wild {

/// @param eaves  world height of its lowest part
Ceiling make_ceiling(CeilingKind kind, const Polygon& outline, float eaves, Dice* dice);

/// The flat pieces that a ceiling consists of, each in the order of the outline.
std::vector<std::vector<Vec3>> facets(const Cell& cell);

}  // namespace lte::datagen::wild
