// Suns and skies that come in through what is open to the outside.
#pragma once

#include "datagen/wild/builder.h"

namespace lte::datagen::wild {

/// Whether any hole without a pane, or a missing ceiling, leads out.
bool is_open(const Plan& plan);

/// Adds a sky, in half of the scenes with a sun that looks in at one of the openings.
void add_sky_and_sun(Builder* builder, Dice* dice);

}  // namespace lte::datagen::wild
