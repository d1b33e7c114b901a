// The light on scene points that a network reads beside them: estimated by paths, or solved on the
// points.
#pragma once

#include <cstdint>
#include <span>

#include "lte/data/light_groups.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/light_estimates.h"
#include "lte/pathtrace/lights/lights.h"
#include "lte/runtime/network.h"
#include "lte/runtime/points.h"
#include "lte/scene/sampler.h"

namespace lte::embed {

/// Owns what ScenePoints borrows.
struct LitSamples {
  scene::SurfaceSamples surface;
  /// W/m²: pathtrace::LightEstimates summed over light groups; what is not read is empty.
  data::PointIrradiance light;

  /// Metallic and roughness of each point; borrows from this.
  std::span<const float> gloss() const {
    static_assert(sizeof(scene::Gloss) == 2 * sizeof(float));
    return {reinterpret_cast<const float*>(surface.gloss.data()), 2 * surface.gloss.size()};
  }
  /// Borrows from this.
  runtime::ScenePoints points() const {
    return {surface.position,    surface.normal, surface.albedo, surface.emission,
            surface.area,        light.direct,   light.indirect, light.direct_back,
            light.indirect_back, light.error,    gloss()};
  }
};

/// For a network that solves light on its points: the light on `lit->surface` in scenes with lights
/// that points describe badly, which are point and spot lights and textured luminaires. Their
/// direct light is traced on both sides of every point, and the solution reflects it. Does nothing
/// for other networks and scenes.
/// @param culled  light groups whose light is left out
void solve_traced_lights(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                         const runtime::ModelConfig& model, uint64_t seed,
                         std::span<const int> culled, LitSamples* lit);

/// The part of estimates by light group that a network of this light_request() reads; borrows from
/// them.
data::GroupedLight light_to_read(const pathtrace::LightEstimates& light,
                                 const runtime::LightRequest& input);

/// Estimates the light on `surface` that a network of this light_request() reads.
/// @param culled  light groups whose light is left out
LitSamples add_light_estimates(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                               scene::SurfaceSamples surface, const runtime::LightRequest& input,
                               uint64_t seed, std::span<const int> culled = {});

}  // namespace lte::embed
