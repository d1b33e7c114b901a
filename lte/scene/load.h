// Scene import.
#pragma once

#include <filesystem>

#include "lte/scene/scene.h"

namespace lte::scene {

/// Caps against hostile files; above each, loading fails with a line that names the count and the
/// cap.
struct LoadLimits {
  int64_t triangles = 400'000'000;
  int64_t texture_pixels = int64_t{1} << 28;  ///< of one texture
  int64_t total_texture_pixels = int64_t{1} << 30;
  int node_depth = 1024;                  ///< also of PBRT's nested attribute blocks
  int64_t includes = 100'000;             ///< files that a PBRT scene includes, repeats counted
  int64_t text_bytes = int64_t{1} << 36;  ///< of PBRT's text, repeats counted
};

/// Reads, told apart by the extension, PBRT v4 (.pbrt), PLY (.ply), either of them in gzip (.gz)
/// too, Wavefront OBJ (.obj), and else glTF 2.0 (.gltf, .glb) through tinygltf;
/// docs/scene-formats.md says what becomes of what. Light groups are numbered in order of emissive
/// instances, then lights.
/// @throws lte::Error naming file and element (PBRT, OBJ: line): missing, truncated or foreign
/// file, index out of range, non-finite
///         position, cyclic nodes, a required extension that lte lacks, no triangles at all.
Scene load_scene(const std::filesystem::path& path, const LoadLimits& limits = {});

/// Reads {"origin":[..],"target":[..],"up":[..],"vfov":degrees}.
/// @throws lte::Error naming file and key.
Camera load_camera(const std::filesystem::path& path);

}  // namespace lte::scene
