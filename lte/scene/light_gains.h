// A scene whose luminaires are dimmed, each by a factor of its own.
#pragma once

#include <span>
#include <vector>

#include "lte/scene/scene.h"

namespace lte::scene {

/// The scene where each light group emits `gains[group]` times what it does. Those of gain 0 emit
/// nothing, and are no lights. Instances, their order, their surfaces and the groups' names are
/// those of the scene: luminaires that share a mesh or a material get copies of their own.
/// @param gains         an entry a light group, not negative
/// @param tree_of_mesh  receives for each mesh of the result the mesh of `scene` that it has the
///                      shape of (pathtrace::Bvh)
/// @throws lte::Error if there are not as many gains as groups, one is negative or not finite, or
///         makes light that is not
Scene with_gains(const Scene& scene, std::span<const float> gains, std::vector<int>* tree_of_mesh);

}  // namespace lte::scene
