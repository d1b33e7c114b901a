// Caps that every importer keeps.
#pragma once

#include <cstdint>
#include <string>

namespace lte::scene {

/// What loading a scene may read and take. Above a cap it fails with a LimitError that names the
/// cap, its value and what was needed.
struct LoadLimits {
  int64_t triangles = 400'000'000;
  int64_t texture_pixels = int64_t{1} << 28;  ///< of one picture
  int64_t picture_bytes = 1'000'000'000;      ///< of all pictures, as the scene keeps them
  /// What gzip and Draco unfold into, over the whole scene.
  int64_t inflated_bytes = 1'000'000'000;
  int64_t text_bytes = int64_t{1} << 36;  ///< of PBRT's text, repeats counted
  int64_t includes = 100'000;             ///< files that a PBRT scene includes, repeats counted
  int node_depth = 1024;                  ///< also of PBRT's nested attribute blocks
  /// Read what the scene names outside the folder of its file, too.
  bool outside = false;
};

/// Caps other than the default ones, from a text as a user gives them: "pictures=4GB,text=500MB".
/// The names are triangles, pixels, pictures, inflated, text and includes; k, M, G and T stand for
/// powers of 1000, Ki, Mi, Gi and Ti for powers of 1024, and a B may follow.
/// @throws lte::Error naming the part that is not understood, and the names there are.
LoadLimits parse_limits(const std::string& text);

}  // namespace lte::scene
