// Caps that every importer keeps.
#pragma once

#include <cstdint>

namespace lte::scene {

/// Caps against hostile files. Above each of them, loading fails with a line that names the count
/// and the cap.
struct LoadLimits {
  int64_t triangles = 400'000'000;
  int64_t texture_pixels = int64_t{1} << 28;  ///< of one texture
  int64_t total_texture_pixels = int64_t{1} << 30;
  int node_depth = 1024;                  ///< also of PBRT's nested attribute blocks
  int64_t includes = 100'000;             ///< files that a PBRT scene includes, repeats counted
  int64_t text_bytes = int64_t{1} << 36;  ///< of PBRT's text, repeats counted
};

}  // namespace lte::scene
