// A picture by path tracing, with its kinds of light by themselves.
#pragma once

#include <cstdint>

#include "infer/bench/pareto/method.h"
#include "lte/pathtrace/render.h"

namespace lte::infer {

/// Radiance towards the camera.
struct TracedPicture {
  image::Image whole;     ///< the sum of what follows, and of light that was reflected once
  image::Image emission;  ///< of lights that the camera sees
  image::Image indirect;  ///< reflected more than once
};

TracedPicture trace_picture(const MethodScene& scene, const scene::Camera& camera, int paths,
                            uint64_t seed, const pathtrace::PixelsDone& done);

}  // namespace lte::infer
