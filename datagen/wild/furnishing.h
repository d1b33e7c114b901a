// Furniture of the homes' kit and of primitives, plants, curtains and clutter.
#pragma once

#include "datagen/homes/kit.h"
#include "datagen/wild/builder.h"

namespace lte::datagen::wild {

/// Furnishes every cell, around what stands there. `kit` lights nothing.
void furnish(Builder* builder, homes::Kit* kit, Dice* dice);

}  // namespace lte::datagen::wild
