// Sun and sky through open windows.
#pragma once

#include "datagen/homes/stage.h"
#include "lte/base/random.h"

namespace lte::datagen::homes {

/// Adds a sky of one radiance or, in `picture_share` of homes, one of CIE's; a sun that looks in at
/// one of the windows, 10 to 55 degrees high, with an irradiance of 1 to 6 times the sky's on a
/// roof; and a hull around the home with the windows' holes in it: walls, floors and ceilings have
/// one face, which the sun would light from outside. The hull is outdoors: its points are in the
/// sun, and some queries are on it.
void add_sun_and_sky(Stage* stage, Kit* kit, const Rgb& sky, double picture_share, Rng* rng);

}  // namespace lte::datagen::homes
