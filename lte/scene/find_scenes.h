// Which of some files and folders are scenes, and which camera stands beside each.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace lte::scene {

struct FoundScene {
  std::filesystem::path path;
  std::string name;              ///< below the folder that was given; unlike all others
  std::filesystem::path camera;  ///< NAME.camera.json beside NAME.glb; empty: there is none
};

struct FoundScenes {
  std::vector<FoundScene> scenes;
  int parts = 0;  ///< files of folders that belong to other scenes
};

/// The scenes among files and folders: .glb, .gltf, .pbrt, .obj and .ply, of folders those in their
/// folders too, in the order of their names. Of a folder, a .pbrt without WorldBegin and a .ply
/// that a .pbrt names are parts of other scenes and left out.
/// @throws lte::Error naming a path that is not there, a file that is no scene or a folder without
///         any
FoundScenes find_scenes(const std::vector<std::string>& places);

}  // namespace lte::scene
