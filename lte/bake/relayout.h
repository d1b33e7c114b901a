// The atlas of a scene that was baked before and has changed since: what is still there keeps its
// place.
#pragma once

#include <string>
#include <vector>

#include "lte/bake/bake.h"

namespace lte::bake {

/// What tells an instance's mesh from others, as 16 hexadecimal digits. [instances]
std::vector<std::string> mesh_fingerprints(const scene::Scene& scene);

/// An atlas as an earlier bake left it.
struct OldAtlas {
  std::string name;  ///< for messages
  int width = 0, height = 0;
  double texels_per_metre = 0;
  bool kept_uvs = false;             ///< Atlas::kept_uvs
  scene::Scene scene;                ///< as Lightmap::scene
  std::vector<std::string> objects;  ///< mesh_fingerprints() of the scene that was baked
};

struct Relayout {
  Layout layout;
  std::vector<int> old_instance;  ///< [instances] of OldAtlas::scene; kNone for what is new
  std::vector<uint8_t> moved;     ///< [instances] 1: stands elsewhere than it did
};

/// Instances of the same mesh and size keep their charts; those that are new get charts where the
/// picture is free.
/// @throws lte::Error where nothing is as it was, or where there is no room
Relayout lay_out_again(const scene::Scene& scene, const OldAtlas& old);

}  // namespace lte::bake
