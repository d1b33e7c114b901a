// Scene import, whatever the format.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lte/scene/import/limits.h"
#include "lte/scene/scene.h"

namespace lte::scene {

/// Reads a scene with the importer that its extension names: glTF 2.0 (.gltf, .glb), PBRT v4
/// (.pbrt), Wavefront OBJ (.obj), PLY (.ply), and PBRT and PLY in gzip (.pbrt.gz, .ply.gz). Case
/// does not matter. docs/scene-formats.md says what becomes of what.
///
/// The file may be anybody's: nothing is read outside its folder, whatever it names, unless
/// `limits.outside` is set.
///
/// Light groups are numbered in the order of emissive instances, then lights. Scene::name is the
/// name of the file without folder and extension.
/// @throws lte::Error naming file and element (PBRT, OBJ: line): an extension that none of the
/// importers has, a missing, truncated or foreign file, an index out of range, a number that is not
/// finite or outside the ranges of number_check.h, cyclic nodes, a required extension of glTF that
/// lte lacks, no triangles at all. OutsideFolder, OverLimit (lte/scene/import/limit_error.h): more
/// than `limits` allow.
Scene load_scene(const std::filesystem::path& path, const LoadLimits& limits = {});

/// The extensions that load_scene() knows: ".gltf", ...
std::vector<std::string> scene_formats();

}  // namespace lte::scene
