// Weights on disk: safetensors with the model's configuration, normalization and a format version
// in the metadata.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "lte/nn/model.h"

namespace lte::nn {

/// Atomic. Metadata: format "lte-model", format_version, model_config (YAML of ModelConfig),
/// lte_version, and `extra`.
void save_model(const std::filesystem::path& path, const LightTransportModel& model,
                const std::map<std::string, std::string>& extra = {});

/// A model in evaluation mode with the file's configuration and weights.
/// @throws lte::Error naming the file and: not a model, newer format, tensor missing, superfluous
/// or of another shape,
///         non-finite weight.
LightTransportModel load_model(const std::filesystem::path& path);

/// Copies weights of `path` into `model`.
/// @throws lte::Error as load_model(), naming both widths if the configurations differ.
void load_weights(const std::filesystem::path& path, LightTransportModel& model);

}  // namespace lte::nn
