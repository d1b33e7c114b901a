// One sample of light arriving at a point.
#pragma once

#include "lte/base/math.h"
#include "lte/scene/scene.h"

namespace lte::pathtrace {

struct LightSample {
  Vec3 direction;      ///< unit, towards the light
  float distance = 0;  ///< INFINITY for directional lights and the environment
  /// Area lights and the environment: radiance. Punctual lights: intensity / distance², which is
  /// irradiance at normal incidence.
  Rgb radiance;
  /// Area lights and the environment: per solid angle. Punctual lights: the discrete probability of
  /// having chosen the light. 0 if nothing arrives.
  float pdf = 0;
  bool delta = false;  ///< a punctual light, which hemisphere sampling cannot meet
  int light_group = scene::kNone;
};

}  // namespace lte::pathtrace
