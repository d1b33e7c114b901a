// Camera files.
#pragma once

#include <filesystem>

#include "lte/scene/scene.h"

namespace lte::scene {

/// Reads {"origin":[..],"target":[..],"up":[..],"vfov":degrees}.
/// @throws lte::Error naming file and key.
Camera load_camera(const std::filesystem::path& path);

}  // namespace lte::scene
