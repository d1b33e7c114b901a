// Everything that fixes the network's shape. Field names are the keys of `model:` in the YAML
// configuration.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lte/base/config.h"

namespace lte::nn {

/// Columns of what a query reads of the light around it (lte/nn/light_cache.h).
inline constexpr int64_t kLightFeatures = 12;

struct ModelConfig {
  int64_t channels = 128;       ///< D; every width scales with it
  int64_t nne_neighbours = 32;  ///< k of the nearest-neighbour embedding
  std::vector<int64_t> encoder_depths = {2, 2, 2, 6, 2};
  std::vector<int64_t> encoder_widths = {1, 1, 1, 2, 2};  ///< in units of D
  std::vector<int64_t> decoder_depths = {2, 2, 2, 2};     ///< PTV3's decoder, shallow to deep
  std::vector<int64_t> decoder_widths = {1, 1, 2, 2};     ///< in units of D
  int64_t head_width = 32;  ///< channels a head; heads = max(1, width / head_width)
  int64_t patch_size = 1024;
  std::string stem = "conv5";     ///< conv5 | conv3 | linear
  double grid_per_spacing = 0.8;  ///< serialization grid over the spacing of the m points
  double dropout = 0.1;           ///< after attention projections and inside MLPs while training
  int64_t query_neighbours = 32;  ///< κ
  int64_t query_layers = 6;
  int64_t gamma_hidden = 64;  ///< h of γ
  /// sum | softmax: the paper's unnormalized sum over the neighbours, or a mean by weights that an
  /// MLP of (q − k + P) gives each channel (lte/nn/query_attention.h).
  std::string query_attention = "sum";
  int64_t ffn_ratio = 4;
  /// emission | direct | traced: what scene points tell of light. The paper's carry emission alone;
  /// `direct` adds the direct irradiance that falls on them, `traced` also an estimate of later
  /// bounces by a few paths (PointSet::direct, PointSet::indirect). The network then says by what
  /// factor irradiance differs from that interpolated between the estimates (lte/nn/light_cache.h).
  std::string light_input = "emission";

  bool normalizes_attention() const { return query_attention == "softmax"; }
  bool reads_direct() const { return light_input != "emission"; }
  bool reads_indirect() const { return light_input == "traced"; }
  /// Columns that a scene point, and a query, go into the network with.
  int64_t query_inputs() const { return reads_indirect() ? 9 + kLightFeatures : 9; }
  int64_t point_inputs() const {
    return 12 + (reads_direct() ? 3 : 0) + (reads_indirect() ? 3 : 0);
  }
  std::string target = "indirect";  ///< indirect | total: what the output means
  double scale = 16.0;              ///< s, metres: network space is (p − b_min)/s
  double output_mean =
      1.0;  ///< training mean of the normalized target; sets the output bias at initialization

  /// Marks its keys as known. @throws lte::Error for values out of range, naming the key.
  static ModelConfig read(const Config& config);
  /// YAML of every field; ModelConfig::read of it gives the same.
  std::string to_yaml() const;
};

}  // namespace lte::nn
