// The albedo at points that have none with them, which a network reads: that of their surface.
#pragma once

#include <vector>

#include "lte/embed/culled_lights.h"
#include "lte/pathtrace/bvh.h"

namespace lte::embed {

/// Looks for a surface along each normal, to either side, within a thousandth of the scene's
/// extent.
/// @return  an entry a point; 0.5 for points on no surface
std::vector<Rgb> albedo_at(const pathtrace::Bvh& bvh, const SurfacePlaces& points);

}  // namespace lte::embed
