// Internal: light samples for blocks of paths.
#pragma once

#include "lte/pathtrace/blocks/path_block.h"
#include "lte/pathtrace/blocks/path_sampler.h"
#include "lte/pathtrace/lights/lights.h"

namespace lte::pathtrace {

/// Lights::sample_in_frame() for `count` lanes, each from its position, its normal and its numbers:
/// plain emissive triangles all at once, the others one by one.
void sample_light_lanes(const Lights& lights, const Lanes3& position, const Lanes3& normal,
                        const LightNumbers& numbers, int count, LightBlock* out);

}  // namespace lte::pathtrace
