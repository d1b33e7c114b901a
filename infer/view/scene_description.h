// What a page must know of a scene to list it, and the replies to clicks and edits.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "infer/session/session.h"
#include "infer/view/view_state.h"
#include "lte/scene/scene.h"

namespace lte::infer::view {

/// `id` is the session's number.
struct LightDescription {
  int id = 0;
  std::string name;
  std::string sort;  ///< "surface", "point", "spot", "sun" or "environment"
};

struct MaterialDescription {
  int id = 0;
  std::string name;
  bool textured = false, emissive = false;
};

/// Something that moves as a whole: an instance, or several that a file places together.
struct ObjectDescription {
  int id = 0;  ///< the session's number of its first instance
  std::string name;
  std::vector<int> instances;    ///< the session's numbers
  std::vector<Affine> to_world;  ///< of each, as loaded or added
  Bounds bounds;                 ///< world, as loaded or added
  bool shines = false;

  /// What it turns and scales about: the middle of its underside.
  Vec3 foot() const { return {bounds.center().x, bounds.low.y, bounds.center().z}; }
};

/// The scene at one moment. The numbers that messages have are the ids in it: what comes and goes
/// changes no other's.
struct SceneDescription {
  std::string name;
  std::vector<LightDescription> lights;
  std::vector<MaterialDescription> materials;
  std::vector<ObjectDescription> objects;
  std::vector<scene::Camera> cameras;
  Bounds bounds;
  std::vector<Shown> outputs;  ///< what can be shown of it
};

/// The one of this `id` among lights, materials, objects or infos of a session; null if there is
/// none.
template <typename Entries>
auto find_entry(const Entries& entries, int id) -> const typename Entries::value_type* {
  for (const auto& entry : entries)
    if (entry.id == id) return &entry;
  return nullptr;
}

/// What is seen at a point of the picture; -1 for none.
struct Picked {
  float x = 0, y = 0;  ///< as asked
  int object = -1, material = -1;
  int light = -1;  ///< that the object shines as
  Vec3 position, normal;
};

/// What an edit made necessary.
struct EditCost {
  std::map<std::string, double> milliseconds;  ///< by stage
  double total_ms = 0;
  int encodings = 0;
  Accuracy accuracy = Accuracy::Full;  ///< of the light that it has led to
};

/// Whether there is a step to take back, and one to make again.
struct UndoSteps {
  bool back = false, forth = false;
};

/// The transform that a placement puts before that of the file.
Affine placed(const Placement& placement, const Vec3& foot);

/// The placement that leads from the transform `loaded` to `now`.
Placement placement_of(const Affine& loaded, const Affine& now, const Vec3& foot);

}  // namespace lte::infer::view
