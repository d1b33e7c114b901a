// Luminaires whose light is lost: a panel that faces the sky above the house, a lamp whose front is
// pressed against a ceiling. They look right in a list of lights, and the picture is black.
#pragma once

#include <string>
#include <vector>

#include "lte/pathtrace/bvh.h"

namespace lte::pathtrace {

/// Light groups, in order.
struct LostLight {
  std::vector<int> missing;  ///< none of the rays that leave them meets a surface
  std::vector<int>
      enclosed;  ///< nearly all rays end next to the lamp: a wall, or a shell around it

  bool empty() const { return missing.empty() && enclosed.empty(); }
};

/// Casts up to 256 rays from each luminaire, along what it emits, and stops at the eighth that gets
/// away from it. "Next to" is within a tenth of the edge of a square of the lamp's area. Suns and
/// environments shine from outside and are never lost; neither is a luminaire without light.
/// @note A surface that is met by less than one ray in 256 is missed. O(emissive triangles).
LostLight find_lost_light(const Bvh& bvh);

/// A warning for each kind of loss, with the names of the luminaires and what to do; none if no
/// light is lost.
void warn_of_lost_light(const std::string& scene, const Bvh& bvh);

}  // namespace lte::pathtrace
