// The automatic view: eye points that stand on a floor inside an enclosure, scored by what they
// see.
#pragma once

#include <cstdint>

#include "lte/pathtrace/bvh.h"
#include "lte/scene/scene.h"

namespace lte::pathtrace {

/// A view from inside the largest free space at eye height that sees much of the scene: candidates
/// are scored by the spread of hit distances, by the share of pixels that meet a front face, and by
/// staying clear of surfaces. Deterministic. Falls back to a view of the bounding box from outside
/// if no point is enclosed.
scene::Camera auto_camera(const Bvh& bvh, uint64_t seed = 0);

}  // namespace lte::pathtrace
