// PBRT v4 scenes.
#pragma once

#include <filesystem>

#include "lte/scene/load.h"

namespace lte::scene::pbrt {

/// load_scene() of a .pbrt file.
/// @throws lte::Error naming file and line.
Scene load_pbrt_scene(const std::filesystem::path& path, const LoadLimits& limits);

}  // namespace lte::scene::pbrt
