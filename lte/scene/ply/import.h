// A PLY file as a scene of its own.
#pragma once

#include "lte/scene/import/scene_files.h"
#include "lte/scene/scene.h"

namespace lte::scene::ply {

/// A scene of one mesh whose vertex colors are the albedo, 0.5 where it has none.
/// Scene::name is left to load_scene().
/// @throws lte::Error as read_ply().
Scene import(SceneFiles* files);

}  // namespace lte::scene::ply
