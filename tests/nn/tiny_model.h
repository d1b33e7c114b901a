// Files of small untrained models, for tests that know nothing of LibTorch.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "lte/nn/config.h"

namespace lte::test {

/// Three stages, patches of 8: every path of the network runs on a few dozen points.
nn::ModelConfig tiny_config();

/// The same in the form of the preset lte: with geometry in attention, in γ, and in the norms.
nn::ModelConfig tiny_geometric_config();

/// Saves a model all of whose parameters are random, so that none is at a special value such as a
/// LayerNorm's 1 and 0.
/// @param metadata  as that of nn::save_model()
void save_random_model(const std::filesystem::path& path, const nn::ModelConfig& config,
                       const std::map<std::string, std::string>& metadata = {});

struct TinyModel {
  int64_t channels = 32;
  double scale = 16;
  int64_t scene_points = 300;
  bool pruned = false;
  bool suns = false;
  nn::LightInput light_input = nn::LightInput::Emission;
  uint64_t seed = 1;
  int64_t radiance_lobes = 0;  ///< above 0 it reads radiosity in place of emission alone
  /// Of a radiance decoder that answers the same for all directions of a point: softplus of it
  /// times the light prior there, over π, is the radiance. Nothing: random weights.
  std::optional<double> even_radiance = {};
};

/// Saves a model of random weights as the trainer does.
void save_tiny_model(const std::filesystem::path& path, const TinyModel& tiny = {});

}  // namespace lte::test
