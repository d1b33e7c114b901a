// Sun and sky of a made scene, and the white of its lamps.
#pragma once

#include "lte/base/random.h"
#include "lte/scene/scene.h"

namespace lte::datagen {

/// A white of luminance 1, from cool (warmth 0) to `warmest` (1).
Rgb light_tint(float warmth, const Rgb& warmest = {1.0f, 0.72f, 0.42f});

/// What shines in at an opening.
struct Daylight {
  Rgb radiance;  ///< W sr^-1 m^-2: what, from all around, would light a roof as the sky does
  /// Towards the sun, whether it shines or not: 10 to 55 degrees high, up to 60 degrees to the
  /// sides of the way out of the opening.
  Vec3 sun;
  float sun_on_roof = 0;  ///< irradiance of the sun on a roof over the sky's; 0: no sun
};

/// A sky through an opening.
/// @param out  horizontal unit vector out of the opening
Daylight daylight(const Rgb& radiance, const Vec3& out, Rng* rng);

/// Adds the sun, with its own light group. Straight above, its irradiance would be 1 to 6 times the
/// sky's on a roof.
void add_sun(Daylight* daylight, Rng* rng, scene::Scene* scene);

/// Adds the sky, with its own light group: one radiance from all around, or in `picture_share` of
/// the skies one of CIE's over a ground that sky and sun light.
void add_sky(const Daylight& daylight, double picture_share, Rng* rng, scene::Scene* scene);

}  // namespace lte::datagen
