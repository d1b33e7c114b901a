// Samples of a scene's surfaces with the light on them that a network asks for.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "infer/light/points.h"
#include "lte/data/light_groups.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/light_estimates.h"
#include "lte/pathtrace/lights/lights.h"
#include "lte/pathtrace/reach/reach.h"
#include "lte/pathtrace/reach/reach_memory.h"
#include "lte/runtime/network.h"
#include "lte/scene/sampler.h"

namespace lte::infer {

/// Raised by every change after which the same seed draws other points, or other light is estimated
/// on them: of embeddings that are kept.
inline constexpr int kScenePointsVersion = 2;

/// Draws the points that describe a scene to the network, as every tool does.
/// @param prune   draw them only where light reaches
/// @param counts  what was pruned; may be null
/// @param recall  what is known of where light reaches
/// @param without  light groups of which, where points are pruned, there are none, nor points that
///                 they alone reach
scene::SurfaceSamples sample_scene_points(const pathtrace::Bvh& bvh, int64_t count, bool prune,
                                          uint64_t seed, pathtrace::PruneCounts* counts,
                                          const pathtrace::ReachRecall& recall = {},
                                          const std::vector<int>& without = {});

/// Owns what ScenePoints borrows.
struct LitSamples {
  scene::SurfaceSamples surface;
  /// W/m²: pathtrace::LightEstimates summed over light groups; what nobody reads is empty.
  data::PointLight light;

  /// Metallic and roughness of each point; borrows from this.
  std::span<const float> gloss() const {
    static_assert(sizeof(scene::Gloss) == 2 * sizeof(float));
    return {reinterpret_cast<const float*>(surface.gloss.data()), 2 * surface.gloss.size()};
  }
  /// Borrows from this.
  ScenePoints points() const {
    return {surface.position,    surface.normal, surface.albedo, surface.emission,
            surface.area,        light.direct,   light.indirect, light.direct_back,
            light.indirect_back, light.error,    gloss()};
  }
};

/// The light on `lit->surface` of a network that solves it on its points, in scenes with lights of
/// which points tell too little: point and spot lights, and luminaires that are textured. Their
/// direct light is traced on both sides of every point, and the solution reflects that. Nothing
/// where there are none, or the network solves no light: it does so by itself.
/// @param left_out  light groups whose light is not to be among it
void solve_traced_lights(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                         const nn::ModelConfig& model, uint64_t seed, std::span<const int> left_out,
                         LitSamples* lit);

/// Of estimates by light group, what a network of this light_request() reads; borrows from them.
data::GroupedLight light_to_read(const pathtrace::LightEstimates& light,
                                 const runtime::LightRequest& input);

/// Estimates the light on `surface` that a network of this light_request() reads.
/// @param left_out  light groups whose light is not to be among it
LitSamples add_light_estimates(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                               scene::SurfaceSamples surface, const runtime::LightRequest& input,
                               uint64_t seed, std::span<const int> left_out = {});

}  // namespace lte::infer
