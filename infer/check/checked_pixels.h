// The pixels of a picture whose light is checked, and what the picture shows there.
#pragma once

#include <cstdint>

#include "infer/check/light_check.h"
#include "lte/render/frame.h"
#include "lte/scene/scene.h"

namespace lte::infer {

/// Indirect irradiance as it was gathered for a picture, before anything corrected it, at one pixel
/// at random in each square of so many: some 2^16 at most, however large the picture is. Without
/// pixels at edges, metal and black surfaces.
/// @param frame  of full, gi or irradiance output
AnsweredLight checked_pixels(const pathtrace::Bvh& bvh, const scene::Camera& camera,
                             const render::Frame& frame, uint64_t seed);

}  // namespace lte::infer
