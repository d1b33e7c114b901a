// Model files: the weights as safetensors, with the model's configuration and a format version in
// the metadata. (A checkpoint is the whole state of a training run: train/checkpoint.)
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "lte/nn/model.h"

namespace lte {
class SafetensorsFile;
}

namespace lte::nn {

/// The format version of model files and of checkpoints, which hold a model_config too.
inline constexpr int64_t kModelFormatVersion = 2;

/// @throws lte::Error in one line naming the file, its version and a remedy, unless its
///         format_version is kModelFormatVersion.
void check_format_version(const SafetensorsFile& file);

/// Writes a model file, atomically. Its metadata are format "lte-model", format_version,
/// model_config (YAML of ModelConfig), lte_version, and `extra`, such as ModelMetadata::entries().
void save_model(const std::filesystem::path& path, const LightTransportModel& model,
                const std::map<std::string, std::string>& extra = {});

/// Writes the model file `from` with its weights rounded to bfloat16, in half the bytes,
/// atomically, with all its metadata. Whoever reads it computes in float32.
/// @throws lte::Error as load_model(), or naming a file that cannot be written.
void save_rounded(const std::filesystem::path& from, const std::filesystem::path& to);

/// A model in evaluation mode with the file's configuration and weights.
/// Warns, in one line that names the tensor, of a weight beyond 10^6.
/// @throws lte::Error naming the file if it is no model, of another format version or damaged (its
///         bytes do not give its checksum; files without one are taken as they are), and naming the
///         tensor that is missing, superfluous, of another shape, or not finite.
LightTransportModel load_model(const std::filesystem::path& path);

/// Copies weights of `path` into `model`.
/// @throws lte::Error as load_model(), naming both widths if the configurations differ.
void load_weights(const std::filesystem::path& path, LightTransportModel& model);

}  // namespace lte::nn
