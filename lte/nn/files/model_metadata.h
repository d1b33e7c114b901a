// Metadata of a model file beside its weights and shape: the scene points of its training, and how
// their light was estimated.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

#include "lte/nn/config.h"

namespace lte::nn {

/// Each field is one of a file's metadata, named alike. A file that lacks it means the default: it
/// is older than the field, or was written by a program that does not know it.
struct ModelMetadata {
  int64_t scene_points = 20'000;     ///< M of the training
  bool scene_points_pruned = false;  ///< training saw scene points only where light reaches them
  bool suns = false;                 ///< training saw scenes with directional lights
  /// Paths a side of each scene point, and their largest number of bounces, behind the light
  /// estimates that a `traced` model was trained with. Its input must be such light: fewer paths
  /// are noisier and fewer bounces darker than all it has seen.
  int light_paths = 32;
  int light_depth = 5;

  /// Metadata for save_model() that hold these fields.
  std::map<std::string, std::string> entries() const;
};

/// @throws lte::Error naming `path` and the key if it is no safetensors file, or a value is out of
///         range or of another type.
ModelMetadata read_model_metadata(const std::filesystem::path& path);

}  // namespace lte::nn
