// A furnished room made in memory, in as many triangles, luminaires and units as one likes: what
// the stability benchmark changes without changing the light in it.
#pragma once

#include <cstdint>

#include "lte/scene/scene.h"

namespace lte::experiments {

struct StressRoom {
  int64_t triangles = 0;    ///< of the surfaces that do not emit, about; 0: as few as they take
  int luminaires = 1;       ///< equal parts that the lamp is cut into, each a light group
  float radiance = 1;       ///< factor on the lamp's
  float scale = 1;          ///< units a metre
  Vec3 offset{};            ///< of the room, in units
  bool coincident = false;  ///< every surface twice, in one place
  /// A triangle without area behind every other one: of one point, of two, or of three in a line.
  bool degenerate = false;
  bool slivers = false;  ///< each surface in strips 1/4096 of its side wide
};

/// A room of 6 x 2.7 x 4 m with four boxes, under one lamp of 0.8 x 0.6 m. The surfaces lie in the
/// same places whatever the options, so that the irradiance at a point is the same but for
/// `radiance`.
scene::Scene make_stress_room(const StressRoom& room);

}  // namespace lte::experiments
