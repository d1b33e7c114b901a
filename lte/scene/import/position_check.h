// A check that every importer ends with.
#pragma once

#include <string>

#include "lte/scene/scene.h"

namespace lte::scene {

/// Checks that every vertex of every instance has a place in the world.
/// @param file  for the message
/// @throws lte::Error naming file and mesh if an instance takes vertices beyond the range of float.
void check_world_positions(const std::string& file, const Scene& scene);

}  // namespace lte::scene
