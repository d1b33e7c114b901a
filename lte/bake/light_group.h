// A scene with the light of one group alone.
#pragma once

#include <vector>

#include "lte/scene/scene.h"

namespace lte::bake {

/// The scene where nothing but one light group emits. Instances, their order and their surfaces are
/// those of the scene.
/// @param tree_of_mesh  for each mesh of the result the mesh of `scene` that it has the shape of
///                      (pathtrace::Bvh)
scene::Scene with_light_of(const scene::Scene& scene, int group, std::vector<int>* tree_of_mesh);

}  // namespace lte::bake
