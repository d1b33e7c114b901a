// Luminaires that bring no light to what a session's cameras see: its network does not read them.
#pragma once

#include <memory>
#include <vector>

#include "infer/session/light_layer.h"
#include "infer/session/scene_edits.h"
#include "lte/scene/scene.h"

namespace lte::infer {

/// Whether both see the same, whatever their names.
bool same_camera(const scene::Camera& a, const scene::Camera& b);
bool same_cameras(const std::vector<scene::Camera>& a, const std::vector<scene::Camera>& b);

/// Cameras but for those that are as the one before: of one that stays for many pictures as many
/// places are looked at as of a single picture's.
std::vector<scene::Camera> without_repeats(std::vector<scene::Camera> cameras);

/// What embed::culled_lights() has found for an edited scene whose luminaires all have gain 1, so
/// that one which is switched off counts as it will when it is on.
struct CulledLights {
  std::shared_ptr<const SceneEdits> found_for;
  std::vector<scene::Camera> cameras;
  std::vector<int> lights;  ///< their numbers, by light group

  /// Whether it holds for an edited scene and cameras.
  bool fits(const SceneEdits& edits, const std::vector<scene::Camera>& seen_by) const;
};

/// The light groups of an edited scene whose numbers are among `lights`.
std::vector<int> groups_of(const SceneEdits& edits, const std::vector<int>& lights);

/// Layers without some light groups; those in which nothing that shines is left are gone.
std::vector<LightGroups> without_groups(std::vector<LightGroups> layers, const SceneEdits& edits,
                                        const std::vector<int>& groups);

}  // namespace lte::infer
