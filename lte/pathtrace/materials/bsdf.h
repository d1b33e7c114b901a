// Internal: what every surface model answers: how much light it scatters from one direction to
// another, and with which density it draws directions.
//
// There are two. A surface without metal is Lambertian (lambert.h); one that is metal wholly or in
// part is a GlossyBsdf (glossy_bsdf.h). Both are reciprocal, and reflect no more than they receive.
#pragma once

#include "lte/base/math.h"

namespace lte::pathtrace {

/// Light from one direction to another.
struct Scattering {
  Rgb value;      ///< f cosθ of the incident direction, 1/sr
  float pdf = 0;  ///< solid-angle density with which sampling makes the incident direction
};

/// A direction that light may come from.
struct ScatteringSample {
  Vec3 direction;  ///< unit
  Rgb weight;      ///< f cosθ / pdf, each channel at most 1
  float pdf = 0;   ///< per solid angle; 0 if the light is lost
};

}  // namespace lte::pathtrace
