// What a state of a session holds, and how one is made from an edited scene.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "infer/renderer/renderer.h"
#include "infer/session/culled_lights.h"
#include "infer/session/light_layer.h"
#include "infer/session/light_records.h"
#include "infer/session/scene_edits.h"
#include "infer/session/session.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/lights/lights.h"

namespace lte::infer {

/// What all states of a session share.
struct SessionBase {
  SessionBase(scene::Scene first, std::optional<runtime::Network> with, SessionSettings how);

  scene::Scene scene;  ///< with its meshes, textures and cameras; the rest is as it began
  std::shared_ptr<const pathtrace::Bvh> trees;  ///< of the meshes
  std::optional<runtime::Network> network;
  SessionSettings settings;
  std::shared_ptr<SharedDenoiser> denoiser = std::make_shared<SharedDenoiser>();
};

/// A layer and the factor by channel of its light.
struct ScaledLayer {
  std::shared_ptr<const LightLayer> layer;
  Rgb scale{1, 1, 1};
};

struct SessionState::Parts {
  std::shared_ptr<const SessionBase> base;
  std::shared_ptr<const SceneEdits> edits;
  std::shared_ptr<const scene::Scene> scene;  ///< with gains and colors
  std::shared_ptr<const pathtrace::Bvh> bvh;
  std::shared_ptr<const pathtrace::Lights> lights;
  /// The last that were drawn of each accuracy, perhaps for a scene before this one; null at first
  /// and without a network.
  std::shared_ptr<const GroupedPoints> full_points, coarse_points;
  std::vector<scene::Camera> cameras;  ///< of Session::look_from()
  /// What was last found, perhaps for a scene or cameras before these; null where nothing is
  /// looked for.
  std::shared_ptr<const CulledLights> culled_lights;
  /// None unless the network answers, and where no light reaches what the cameras see.
  std::vector<ScaledLayer> layers;
  bool asks_network = false;
  std::optional<Method> answered_by;  ///< SessionState::answered_by()
  /// Of gathered pictures, perhaps of a scene before this one; null for others.
  std::shared_ptr<const LightRecords> records;
  std::shared_ptr<LazyCache> cache;  ///< of the records, with the gains of now
  Accuracy accuracy = Accuracy::Full;
  uint64_t version = 0;

  /// Sums over the layers.
  std::vector<Rgb> answer(const runtime::QueryPoints& queries) const;
  /// The cache of what answers now, from the records.
  std::shared_ptr<LazyCache> make_cache() const;
  /// SessionState::render()
  Frame render(const scene::Camera& camera, RenderSettings settings, StageSeconds* seconds) const;
};

/// Of the meshes, which each state has its own copy of.
int64_t scene_bytes(const scene::Scene& scene);

/// A scene with its tree and lights.
struct Traced {
  std::shared_ptr<const scene::Scene> scene;
  std::shared_ptr<const pathtrace::Bvh> bvh;
  std::shared_ptr<const pathtrace::Lights> lights;
};

/// @param lit     as in make_scene()
/// @param report  gets scene_ms and bvh_ms
Traced trace(const SessionBase& base, const SceneEdits& edits, bool lit, EditReport* report);

/// What make_parts() is asked for.
struct Wanted {
  Accuracy least = Accuracy::Full;
  std::function<void()> check = {};  ///< called now and then by any thread; may throw, may be null
  /// Nothing: those of before, or of the session's settings.
  std::optional<std::vector<scene::Camera>> cameras = {};
};

/// Makes what an edited scene needs that `before` has not got. Its version is that of `before`
/// where other cameras of the same scene have changed no answer.
/// @param before  null for all of it
/// @param report  gets times and counts
std::unique_ptr<SessionState::Parts> make_parts(std::shared_ptr<const SessionBase> base,
                                                std::shared_ptr<const SceneEdits> edits,
                                                const SessionState::Parts* before,
                                                const Wanted& wanted, EditReport* report);

}  // namespace lte::infer
