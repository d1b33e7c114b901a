// Samples of a scene's surfaces with the light on them that a network asks for.
#pragma once

#include <cstdint>
#include <vector>

#include "infer/common/points.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/lights.h"
#include "lte/runtime/network.h"
#include "lte/scene/sampler.h"

namespace lte::infer {

/// Owns what ScenePoints borrows.
struct LitSamples {
  scene::SurfaceSamples surface;
  /// W/m², or empty: pathtrace::LightEstimates summed over light groups.
  std::vector<Rgb> direct, indirect;

  /// Borrows from this.
  ScenePoints points() const {
    return {surface.position, surface.normal, surface.albedo, surface.emission,
            surface.area,     direct,         indirect};
  }
};

/// Estimates the light on `surface` that a network of this light_request() reads.
LitSamples add_light_estimates(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                               scene::SurfaceSamples surface, const runtime::LightRequest& input,
                               uint64_t seed);

}  // namespace lte::infer
