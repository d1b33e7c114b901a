// What a bake leaves in its folder for --since: samples, picture, atlas and scene.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "infer/bake/bake_command.h"
#include "lte/bake/rebake.h"
#include "lte/base/file.h"

namespace lte::infer {

/// Files of it.
inline constexpr const char* kKeptSamples = "since.safetensors";
inline constexpr const char* kKeptScene = "since.glb";

/// Flags by name, and what else makes samples of two bakes no mixture.
using BakeSettings = std::map<std::string, std::string>;
BakeSettings settings_of(const BakeRequest& request, const scene::Scene& scene);

struct KeptBake {
  bake::OldAtlas atlas;
  bake::OldLight light;
  double expected_error = 0;
};

/// The bake in the folder of request.since.
/// @throws lte::Error naming the folder where it has no such files, or where they are damaged or
///         were made with other settings
KeptBake read_kept(const BakeRequest& request, const scene::Scene& scene);

/// What write_kept() writes beside a light map.
struct ToKeep {
  BakeSettings settings;
  bool kept_uvs = false;
  std::vector<std::string> objects;  ///< bake::mesh_fingerprints()
  bake::OldLight light;              ///< but for picture and mask, which the map has
};
void write_kept(const ToKeep& keep, const bake::Lightmap& map, FileSet* files);

}  // namespace lte::infer
