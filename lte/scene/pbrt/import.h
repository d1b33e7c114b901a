// PBRT v4 scenes.
#pragma once

#include "lte/scene/import/scene_files.h"
#include "lte/scene/scene.h"

namespace lte::scene::pbrt {

/// Reads a .pbrt file with all that it includes; either may be gzip.
/// Scene::name is left to load_scene().
/// @throws lte::Error naming file and line.
Scene import(SceneFiles* files);

}  // namespace lte::scene::pbrt
