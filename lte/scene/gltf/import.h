// glTF 2.0 to a scene.
#pragma once

#include "lte/scene/import/scene_files.h"
#include "lte/scene/scene.h"

namespace lte::scene::gltf {

/// Reads a .gltf or .glb, told apart by content. Each triangle primitive of a node becomes an
/// instance.
/// Scene::name is left to load_scene().
/// @throws lte::Error naming file and element; see open_file() and check_document().
Scene import(SceneFiles* files);

}  // namespace lte::scene::gltf
