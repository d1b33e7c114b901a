// Everything that fixes the network's shape. Field names are the keys of `model:` in the YAML
// configuration.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lte/base/config.h"
#include "lte/ops/pair_geometry.h"

namespace lte::nn {

/// Columns that a query reads of the light around it (lte/nn/points/light_prior.h), without the
/// error of estimates, which is one more.
inline constexpr int64_t kLightFeatures = 12;
/// Columns that F reads of the gloss of a scene point, its last ones.
inline constexpr int64_t kGlossColumns = 2;

/// The form of the network, and the default of every other key (ModelConfig::of()).
///
/// - Paper: the paper's network. A submanifold convolution of 5³ cells is the stem, patch attention
///   sees features alone, norms share nothing between points, and γ of the query decoder reads
///   offsets.
/// - Lte: a stem of 3³ cells, rotary positions in patch attention (lte/ops/rotary.h), norms that
///   subtract a learnt share of each channel's mean over the scene's points (GraphNorm, Cai et al.
///   2021), and the normals of query and latent among what γ reads (lte/ops/pair_geometry.h),
///   without which a latent behind a board weighs as much as one before it.
enum class Preset { Paper, Lte };

/// The light that scene points carry. The paper's carry emission alone. `Traced` adds the
/// irradiance that falls on either side of the surface there, direct and after one bounce or more,
/// estimated by a few paths, with the standard error of the latter (PointSet). `Radiosity` adds the
/// same without errors, solved on the points themselves (lte/radiosity/point_radiosity.h). Networks
/// that read light answer with a factor on what is interpolated between the points
/// (lte/nn/points/light_prior.h).
enum class LightInput { Emission, Traced, Radiosity };

constexpr EnumNames<Preset, 2> enum_names(Preset) {
  return {{{Preset::Paper, "paper"}, {Preset::Lte, "lte"}}};
}
constexpr EnumNames<LightInput, 3> enum_names(LightInput) {
  return {{{LightInput::Emission, "emission"},
           {LightInput::Traced, "traced"},
           {LightInput::Radiosity, "radiosity"}}};
}

/// The defaults are the paper's.
struct ModelConfig {
  Preset preset = Preset::Paper;
  int64_t channels = 128;       ///< D; every width scales with it
  int64_t nne_neighbours = 32;  ///< k of the nearest-neighbour embedding
  std::vector<int64_t> encoder_depths = {2, 2, 2, 6, 2};
  std::vector<int64_t> encoder_widths = {1, 1, 1, 2, 2};  ///< in units of D
  std::vector<int64_t> decoder_depths = {2, 2, 2, 2};     ///< PTV3's decoder, shallow to deep
  std::vector<int64_t> decoder_widths = {1, 1, 2, 2};     ///< in units of D
  int64_t head_width = 32;  ///< channels a head; heads = max(1, width / head_width)
  int64_t patch_size = 1024;
  double dropout = 0.1;           ///< after attention projections and inside MLPs while training
  int64_t query_neighbours = 32;  ///< κ
  int64_t query_layers = 6;
  LightInput light_input = LightInput::Emission;
  /// Functions of direction that the radiance decoder makes for each point
  /// (lte/nn/decoder/radiance_decoder.h). 0: the model has no such decoder. Models with one read
  /// the gloss of scene points (PointSet::gloss), and light.
  int64_t radiance_lobes = 0;
  double scale = 16.0;  ///< s, metres: network space is (p − b_min)/s
  /// Training mean of the normalized target. It sets the output bias at initialization.
  double output_mean = 1.0;

  /// The defaults of a preset.
  static ModelConfig of(Preset preset);

  int64_t stem_kernel() const { return preset == Preset::Lte ? 3 : 5; }  ///< edge in cells
  bool rotates_attention() const { return preset == Preset::Lte; }
  bool centers_norms() const { return preset == Preset::Lte; }
  bool reads_normals() const { return preset == Preset::Lte; }
  /// Serialization grid over the spacing of the m points.
  double grid_per_spacing() const { return preset == Preset::Lte ? 1.6 : 0.8; }
  bool reads_light() const { return light_input != LightInput::Emission; }
  /// Whether the light on scene points is solved rather than given.
  bool solves_light() const { return light_input == LightInput::Radiosity; }
  /// Whether scene points carry light that was estimated by paths, and its errors.
  bool reads_estimates() const { return light_input == LightInput::Traced; }
  bool predicts_radiance() const { return radiance_lobes > 0; }
  /// Columns that γ reads.
  int64_t pair_inputs() const { return reads_normals() ? ops::kNormalInputs : ops::kOffsetInputs; }
  /// Columns that a query, and a scene point, go into the network with.
  int64_t query_inputs() const {
    return 9 + (reads_light() ? kLightFeatures : 0) + (reads_estimates() ? 1 : 0);
  }
  int64_t point_inputs() const {
    return 12 + (reads_light() ? 12 : 0) + (reads_estimates() ? 2 : 0) +
           (predicts_radiance() ? kGlossColumns : 0);
  }

  /// Marks its keys as known. Keys that are absent have the default of `preset`.
  /// @throws lte::Error for values out of range, naming the key.
  static ModelConfig read(const Config& config);
  /// YAML of every field; ModelConfig::read of it gives the same.
  std::string to_yaml() const;
};

/// A key whose value differs between two configurations, and both values as in YAML.
struct ConfigDifference {
  std::string key, first, second;
};

/// In the order of the keys of to_yaml().
std::vector<ConfigDifference> differences(const ModelConfig& first, const ModelConfig& second);

}  // namespace lte::nn
