// What a model's file says beside its weights and shape: the scene points of its training.
#pragma once

#include <cstdint>
#include <filesystem>

namespace lte::nn {

struct ModelMetadata {
  int64_t scene_points = 20'000;     ///< M of the training; this default if the file does not say
  bool scene_points_pruned = false;  ///< training saw scene points only where light reaches them
};

/// @throws lte::Error naming `path` and the key if it is no safetensors file or a value is no
/// number, or neither true nor false.
ModelMetadata read_model_metadata(const std::filesystem::path& path);

}  // namespace lte::nn
