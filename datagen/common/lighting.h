// Colors of light, sun and sky of a made scene.
#pragma once

#include "lte/base/random.h"
#include "lte/scene/scene.h"

namespace lte::datagen {

/// A white of luminance 1, from cool (warmth 0) to warm (1).
Rgb light_tint(float warmth);

/// Adds a sky of one radiance from all around, with its own light group.
/// @param radiance  W sr^-1 m^-2
void add_sky(const Rgb& radiance, scene::Scene* scene);

/// Adds a sun that looks in at an opening, 10 to 55 degrees high, with its own light group.
/// @param out  horizontal unit vector out of the opening; the sun stands up to 60 degrees to its
///             sides
/// @param sky  its irradiance is 1 to 6 times what this radiance gives on a roof
void add_sun(const Vec3& out, const Rgb& sky, Rng* rng, scene::Scene* scene);

}  // namespace lte::datagen
