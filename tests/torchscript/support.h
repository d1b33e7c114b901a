// Models to export, and files that a program without lte reads and writes.
#pragma once

#include <filesystem>
#include <fstream>

#include <ATen/ops/empty_like.h>
#include <torch/utils.h>

#include "lte/nn/files/model_file.h"

namespace lte::test {

inline nn::ModelConfig small_config(nn::Preset preset) {
  nn::ModelConfig config;
  config.preset = preset;
  config.channels = 32;
  config.encoder_depths = {2, 1, 1};
  config.encoder_widths = {1, 1, 2};
  config.decoder_depths = {1, 2};
  config.decoder_widths = {1, 2};
  config.patch_size = 64;  // so that the first stages are cut into patches
  config.query_layers = 2;
  return config;
}

inline std::filesystem::path save_untrained(const std::filesystem::path& folder,
                                            const nn::ModelConfig& config) {
  torch::manual_seed(5);
  nn::LightTransportModel model(config);
  const std::filesystem::path path = folder / "model.safetensors";
  nn::save_model(path, model);
  return path;
}

inline void write_rows(const std::filesystem::path& path, const at::Tensor& rows) {
  const at::Tensor flat = rows.contiguous();
  std::ofstream(path, std::ios::binary)
      .write(static_cast<const char*>(flat.const_data_ptr()),
             static_cast<std::streamsize>(flat.nbytes()));
}

/// As large as `like`.
inline at::Tensor read_rows(const std::filesystem::path& path, const at::Tensor& like) {
  at::Tensor rows = at::empty_like(like).contiguous();
  std::ifstream(path, std::ios::binary)
      .read(static_cast<char*>(rows.data_ptr()), static_cast<std::streamsize>(rows.nbytes()));
  return rows;
}

}  // namespace lte::test
