// The point of a scene's surfaces that is nearest to a place.
#pragma once

#include "lte/base/math.h"
#include "lte/scene/scene.h"
#include "lte/scene/surface.h"

namespace lte::experiments {

struct ClosestPoint {
  scene::Surface
      surface;  ///< its normal is of the side on which the place lies, or of the front if on it
  float distance = 0;
};

/// Looks at every triangle: some 50 ns each.
/// @throws lte::Error if the place is not finite, or the scene has no triangle with an area
ClosestPoint closest_point(const scene::Scene& scene, const Vec3& place);

}  // namespace lte::experiments
