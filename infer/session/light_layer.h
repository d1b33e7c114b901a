// Scene points with the light on them by luminaire, and what a network makes of some of the
// luminaires: layers, whose answers are summed.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "infer/renderer/renderer.h"
#include "infer/session/scene_edits.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/light_estimates.h"
#include "lte/pathtrace/lights/lights.h"
#include "lte/pathtrace/reach/reach.h"
#include "lte/pathtrace/reach/reach_memory.h"
#include "lte/runtime/embedding.h"
#include "lte/runtime/network.h"
#include "lte/scene/sampler.h"

namespace lte::infer {

/// The points that describe a scene whose luminaires all have gain 1.
struct GroupedPoints {
  std::shared_ptr<const SceneEdits> drawn_for;
  std::vector<int> culled;  ///< luminaires that count as none, by their numbers
  scene::SurfaceSamples surface;
  /// By light group; nothing for a network that reads no light.
  std::optional<pathtrace::LightEstimates> light;
  pathtrace::PruneCounts pruned;
  pathtrace::ReachMemory reach;  ///< of points that light does not reach
};

/// Points from before a change that moved surfaces and left light and colors alone.
struct PointsBefore {
  const GroupedPoints* points = nullptr;  ///< null: none
  std::vector<Bounds> changed;            ///< where surfaces are gone or new
};

/// Draws the points and estimates the light on them, as Renderer::embed() does.
/// @param settings  `culled_lights` of this edited scene
/// @param accuracy  Coarse or Full
/// @param check     called now and then by any thread; what it throws ends it. May be null.
/// @param report    gets points_ms, light_ms and points_drawn
GroupedPoints draw_points(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                          const runtime::Network& network, const EmbedSettings& settings,
                          const PointsBefore& before, Accuracy accuracy,
                          const std::function<void()>& check, EditReport* report);

/// Luminaires whose light is encoded together.
struct LightGroups {
  std::vector<int> groups;  ///< in order, at least one
  /// As bright as they are now, and not at gain 1: then no gain stands beside the answers.
  bool as_dimmed = false;
  friend bool operator==(const LightGroups&, const LightGroups&) = default;
};

/// The light groups of each layer that has light: the untouched ones together, each touched one by
/// itself.
std::vector<LightGroups> layers_apart(const SceneEdits& edits);
/// All that shine now in one layer, at their gains; none in the dark.
std::vector<LightGroups> layers_together(const SceneEdits& edits);

/// The encoding of the light of some groups.
struct LightLayer {
  std::shared_ptr<const GroupedPoints> points;
  std::vector<int> lights;  ///< luminaires, by their numbers
  std::vector<Rgb> gains;   ///< of each, where they are encoded as dimmed; otherwise none
  std::shared_ptr<const runtime::SceneEmbedding> embedding;

  /// Whether it is the layer of these groups of an edited scene.
  bool is(const SceneEdits& edits, const LightGroups& wanted) const;
};

/// Encodes the light of some groups alone. The points of other luminaires are left out: in the dark
/// they would be surfaces whose light nobody has estimated.
std::shared_ptr<const LightLayer> encode_layer(const SceneEdits& edits,
                                               std::shared_ptr<const GroupedPoints> points,
                                               const LightGroups& wanted,
                                               const runtime::Network& network,
                                               const EmbedSettings& settings);

}  // namespace lte::infer
