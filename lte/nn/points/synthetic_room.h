// A stand-in for a scene where only time and agreement matter, not light.
#pragma once

#include <cstdint>

#include "lte/nn/points/point_set.h"

namespace lte::nn {

/// Draws `count` points on the surfaces of a furnished box room with a ceiling lamp, float32 on the
/// CPU, with random irradiance on their sides. The same for the same seed.
PointSet synthetic_room(int64_t count, uint64_t seed);

}  // namespace lte::nn
