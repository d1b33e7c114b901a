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
  int node_depth = 1024;
};

/// Reads Wavefront OBJ (.obj) and else glTF 2.0 (.gltf, .glb) through tinygltf; what becomes of
/// what is in docs/scene-formats.md. Light groups are numbered in order of emissive instances, then
/// lights.
/// @throws lte::Error naming file and element: missing, truncated or foreign file, index out of
/// range, non-finite
///         position, cyclic nodes, a required extension that lte lacks, no triangles at all.
Scene load_scene(const std::filesystem::path& path, const LoadLimits& limits = {});

/// Reads {"origin":[..],"target":[..],"up":[..],"vfov":degrees}.
/// @throws lte::Error naming file and key.
Camera load_camera(const std::filesystem::path& path);

}  // namespace lte::scene
