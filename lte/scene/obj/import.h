// Wavefront OBJ to a scene.
#pragma once

#include "lte/scene/import/scene_files.h"
#include "lte/scene/scene.h"

namespace lte::scene::obj {

/// One mesh and one instance for the faces of one object in one material. OBJ has no unit: metres.
/// Scene::name is left to load_scene().
/// @throws lte::Error naming file and line; see read_obj() and read_mtl().
Scene import(SceneFiles* files);

}  // namespace lte::scene::obj
