// How much light the luminaires of a scene send out.
#pragma once

#include <vector>

#include "lte/scene/scene.h"

namespace lte::scene {

/// The power of a point or spot light in W; 0 for a sun. A spot's falloff is that of
/// KHR_lights_punctual, the square of a ramp in the cosine, which has a closed integral.
Rgb punctual_power(const PunctualLight& light);

/// Radiant power by light group, W, by channel, as bright as the scene has them: of surfaces,
/// points and spots. Suns and environments count 0, since what they send into a scene hangs on its
/// size.
std::vector<Rgb> luminaire_powers(const Scene& scene);

/// The median of the luminances of those powers that are not 0; 0 where all are.
float median_power(const std::vector<Rgb>& powers);

}  // namespace lte::scene
