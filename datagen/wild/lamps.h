// Luminaires of every kind and size, where they shine into a room or round its corner.
#pragma once

#include "datagen/homes/kit.h"
#include "datagen/wild/builder.h"

namespace lte::datagen::wild {

/// Places up to `wanted` lamps, at least one, and records them with unit brightness.
void place_lamps(int wanted, Builder* builder, homes::Kit* kit, Dice* dice);

/// Shares `watts` among the lamps.
void set_powers(float watts, Builder* builder, Dice* dice);

/// Panes in the windows that no lamp has filled: dark ones in most, none in the others.
void close_windows(Builder* builder, Dice* dice);

}  // namespace lte::datagen::wild
