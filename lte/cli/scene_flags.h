// The flags of every tool that loads scenes: what a scene may read and take.
#pragma once

#include <filesystem>
#include <string>

namespace CLI {
class App;
}
namespace lte::scene {
struct Scene;
}

namespace lte {

struct SceneFlags {
  bool allow_outside = false;
  std::string limits;  ///< "pictures=4GB,inflated=2GB"; empty for the default ones
};

/// Adds --allow-outside and --limits.
void add_scene_flags(CLI::App& app, SceneFlags* flags);

/// Loads a scene as the flags allow: the only way in which tools do.
/// @throws lte::Error as scene::load_scene(); where a flag would help, the message ends with it:
/// "(--allow-outside)".
scene::Scene load_scene(const std::filesystem::path& path, const SceneFlags& flags);

}  // namespace lte
