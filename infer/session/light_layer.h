// Scene points with the light on them by luminaire, and what a network makes of some of the
// luminaires: layers, whose answers are summed.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "infer/renderer/renderer.h"
#include "infer/session/draft.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/light_estimates.h"
#include "lte/pathtrace/lights.h"
#include "lte/pathtrace/reach.h"
#include "lte/pathtrace/reach_memory.h"
#include "lte/runtime/embedding.h"
#include "lte/runtime/network.h"
#include "lte/scene/sampler.h"

namespace lte::infer {

/// The points that describe a scene whose luminaires all have gain 1.
struct GroupedPoints {
  scene::SurfaceSamples surface;
  /// By light group; nothing for a network that reads no light.
  std::optional<pathtrace::LightEstimates> light;
  pathtrace::PruneCounts pruned;
  pathtrace::ReachMemory reach;  ///< of points that light does not reach
};

/// Points from before a change that moved surfaces and left light and colours alone.
struct PointsBefore {
  const GroupedPoints* points = nullptr;  ///< null: none
  std::vector<Bounds> changed;            ///< where surfaces are gone or new
};

/// Draws the points and estimates the light on them, as Renderer::embed() does.
/// @param report  gets points_ms, light_ms and points_drawn
GroupedPoints draw_points(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                          const runtime::Network& network, const EmbedSettings& settings,
                          const PointsBefore& before, EditReport* report);

/// The encoding of the light of some groups.
struct LightLayer {
  std::shared_ptr<const GroupedPoints> points;
  std::vector<int> lights;  ///< luminaires, by their numbers
  std::shared_ptr<const runtime::SceneEmbedding> embedding;
};

/// Encodes the light of `groups` alone. The points of other luminaires are left out: in the dark
/// they would be surfaces whose light nobody has estimated.
/// @param groups  in order, at least one
std::shared_ptr<const runtime::SceneEmbedding> encode_groups(const Draft& draft,
                                                             const GroupedPoints& points,
                                                             const std::vector<int>& groups,
                                                             const runtime::Network& network,
                                                             const EmbedSettings& settings);

}  // namespace lte::infer
