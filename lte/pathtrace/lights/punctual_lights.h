// Point, spot and directional lights (glTF's KHR_lights_punctual).
#pragma once

#include "lte/base/math.h"
#include "lte/pathtrace/lights/light_sample.h"
#include "lte/scene/scene.h"

namespace lte::pathtrace {

/// Radiant power by luminance; a directional light's through the disc that bounds the scene.
double punctual_power(const scene::PunctualLight& light, const Bounds& bounds);

/// The light at a point, with `pdf` 1 if it arrives and 0 if not.
/// @param origin    frame_origin()
/// @param position  relative to it
LightSample sample_punctual(const scene::PunctualLight& light, const Vec3& origin,
                            const Vec3& position);

}  // namespace lte::pathtrace
