// Everything that fixes the network's shape. Field names are the keys of `model:` in the YAML
// configuration.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lte/base/config.h"
#include "lte/ops/pair_geometry.h"

namespace lte::nn {

/// Columns of what a query reads of the light around it (lte/nn/light_cache.h).
inline constexpr int64_t kLightFeatures = 12;
/// The columns of those and of what `light_variance` adds.
inline constexpr int64_t kMostLightFeatures = kLightFeatures + 1;
/// Columns of what F reads of the gloss of a scene point, its last ones.
inline constexpr int64_t kGlossColumns = 2;

/// How scene points enter the encoder: a submanifold convolution of 5³ or 3³ cells, or a layer that
/// looks at each point alone.
enum class Stem { Conv5, Conv3, Linear };

/// How a query weighs its neighbours: the paper's unnormalized sum, or a mean by weights that an
/// MLP of (q − k + P) gives each channel (lte/nn/query_attention.h).
enum class QueryAttention { Sum, Softmax };

/// What tells patch attention where two points lie to each other: nothing but their features, as in
/// the paper, or the cells of the points (lte/ops/rotary.h).
enum class AttentionPositions { None, Rotary };

/// What γ of the query decoder reads of a query and a latent: the offset between them, as in the
/// paper, or their normals too (lte/ops/pair_geometry.h), without which a latent behind a board
/// weighs as one before it.
enum class PairGeometry { Offset, Normals };

/// What the encoder's norms after convolutions, the stem, pooling and unpooling subtract: nothing
/// that points share, or a learnt share of each channel's mean over the scene's points (GraphNorm,
/// Cai et al. 2021). PTv3 has batch normalization there, which subtracts it too.
enum class Centering { None, Learned };

/// What scene points tell of light. The paper's carry emission alone. `Direct` adds the direct
/// irradiance that falls on them, and `Traced` also an estimate of later bounces by a few paths
/// (PointSet::direct, PointSet::indirect). A network that reads traced light answers by what factor
/// irradiance differs from that interpolated between the estimates (lte/nn/light_cache.h).
/// `Radiosity` is the same with light that is solved on the points themselves, of their emission
/// (lte/radiosity/point_radiosity.h), so that nobody has to trace a path.
enum class LightInput { Emission, Direct, Traced, Radiosity };

/// How the light on the two sides of a surface is told: its sum, so that a curtain tells neither
/// side's, or that of the front and of the back, each by itself. A query of a `traced` network then
/// reads only the side that faces as it does.
enum class LightSides { Sum, Apart };

/// What the radiance decoder's answer is a factor on: the irradiance that models which read bounced
/// light are told of, from everywhere alike, or beside it what a ray sees of the scene points
/// (lte/nn/surfels.h).
enum class RadianceBase { Irradiance, Points };

/// How the radiance decoder answers (lte/nn/radiance_decoder.h): a perceptron asked direction by
/// direction, a map of all directions in one pass, or a sum of spherical Gaussians; or `Early`,
/// where each direction of a point is a query of its own that passes all layers.
enum class RadianceHead { Directions, Map, Gaussians, Early };

/// What the output means: light that bounced at least once, or all of it.
enum class Target { Indirect, Total };

constexpr EnumNames<Stem, 3> enum_names(Stem) {
  return {{{Stem::Conv5, "conv5"}, {Stem::Conv3, "conv3"}, {Stem::Linear, "linear"}}};
}
constexpr EnumNames<QueryAttention, 2> enum_names(QueryAttention) {
  return {{{QueryAttention::Sum, "sum"}, {QueryAttention::Softmax, "softmax"}}};
}
constexpr EnumNames<AttentionPositions, 2> enum_names(AttentionPositions) {
  return {{{AttentionPositions::None, "none"}, {AttentionPositions::Rotary, "rotary"}}};
}
constexpr EnumNames<PairGeometry, 2> enum_names(PairGeometry) {
  return {{{PairGeometry::Offset, "offset"}, {PairGeometry::Normals, "normals"}}};
}
constexpr EnumNames<Centering, 2> enum_names(Centering) {
  return {{{Centering::None, "none"}, {Centering::Learned, "learned"}}};
}
constexpr EnumNames<LightInput, 4> enum_names(LightInput) {
  return {{{LightInput::Emission, "emission"},
           {LightInput::Direct, "direct"},
           {LightInput::Traced, "traced"},
           {LightInput::Radiosity, "radiosity"}}};
}
constexpr EnumNames<LightSides, 2> enum_names(LightSides) {
  return {{{LightSides::Sum, "sum"}, {LightSides::Apart, "apart"}}};
}
constexpr EnumNames<RadianceBase, 2> enum_names(RadianceBase) {
  return {{{RadianceBase::Irradiance, "irradiance"}, {RadianceBase::Points, "points"}}};
}
constexpr EnumNames<RadianceHead, 4> enum_names(RadianceHead) {
  return {{{RadianceHead::Directions, "directions"},
           {RadianceHead::Map, "map"},
           {RadianceHead::Gaussians, "gaussians"},
           {RadianceHead::Early, "early"}}};
}
constexpr EnumNames<Target, 2> enum_names(Target) {
  return {{{Target::Indirect, "indirect"}, {Target::Total, "total"}}};
}

struct ModelConfig {
  int64_t channels = 128;       ///< D; every width scales with it
  int64_t nne_neighbours = 32;  ///< k of the nearest-neighbour embedding
  std::vector<int64_t> encoder_depths = {2, 2, 2, 6, 2};
  std::vector<int64_t> encoder_widths = {1, 1, 1, 2, 2};  ///< in units of D
  std::vector<int64_t> decoder_depths = {2, 2, 2, 2};     ///< PTV3's decoder, shallow to deep
  std::vector<int64_t> decoder_widths = {1, 1, 2, 2};     ///< in units of D
  int64_t head_width = 32;  ///< channels a head; heads = max(1, width / head_width)
  int64_t patch_size = 1024;
  Stem stem = Stem::Conv5;
  AttentionPositions attention_positions = AttentionPositions::None;
  Centering centering = Centering::None;
  double grid_per_spacing = 0.8;  ///< serialization grid over the spacing of the m points
  double dropout = 0.1;           ///< after attention projections and inside MLPs while training
  int64_t query_neighbours = 32;  ///< κ
  int64_t query_layers = 6;
  int64_t gamma_hidden = 64;  ///< h of γ
  PairGeometry pair_geometry = PairGeometry::Offset;
  QueryAttention query_attention = QueryAttention::Sum;
  int64_t ffn_ratio = 4;
  LightInput light_input = LightInput::Emission;
  LightSides light_sides = LightSides::Sum;
  /// Scene points and queries are told the standard error of the traced estimates
  /// (PointSet::indirect_error).
  bool light_variance = false;
  /// Scene points tell how metallic and how rough they are (PointSet::gloss).
  bool gloss = false;
  /// Functions of direction that the radiance decoder makes for each point
  /// (lte/nn/radiance_decoder.h), cells along an edge of its map, or its spherical Gaussians; early
  /// ones have no use for the number. 0: the model has no such decoder.
  int64_t radiance_lobes = 0;
  RadianceHead radiance_head = RadianceHead::Directions;
  RadianceBase radiance_base = RadianceBase::Irradiance;
  Target target = Target::Indirect;
  double scale = 16.0;  ///< s, metres: network space is (p − b_min)/s
  /// Training mean of the normalized target. It sets the output bias at initialization.
  double output_mean = 1.0;

  bool normalizes_attention() const { return query_attention == QueryAttention::Softmax; }
  bool rotates_attention() const { return attention_positions == AttentionPositions::Rotary; }
  bool reads_normals() const { return pair_geometry == PairGeometry::Normals; }
  bool reads_direct() const { return light_input != LightInput::Emission; }
  bool reads_indirect() const { return light_input == LightInput::Traced || solves_light(); }
  /// Whether the light on scene points is solved rather than given.
  bool solves_light() const { return light_input == LightInput::Radiosity; }
  /// Whether scene points carry light that was estimated by paths.
  bool reads_estimates() const { return reads_direct() && !solves_light(); }
  bool parts_sides() const { return light_sides == LightSides::Apart; }
  /// Edge in cells of the stem's convolution; 0 for a linear stem.
  int64_t stem_kernel() const { return stem == Stem::Conv5 ? 5 : stem == Stem::Conv3 ? 3 : 0; }
  bool predicts_radiance() const { return radiance_lobes > 0; }
  /// Whether the radiance decoder sees the scene points by rays.
  bool casts_rays() const { return predicts_radiance() && radiance_base == RadianceBase::Points; }
  /// Whether each direction is a query of its own in the radiance decoder.
  bool enters_early() const { return radiance_head == RadianceHead::Early; }
  bool predicts_total() const { return target == Target::Total; }
  /// Columns that γ reads.
  int64_t pair_inputs() const { return reads_normals() ? ops::kNormalInputs : ops::kOffsetInputs; }
  /// Columns that a query, and a scene point, go into the network with.
  int64_t query_inputs() const {
    return 9 + (reads_indirect() ? kLightFeatures : 0) + (light_variance ? 1 : 0);
  }
  int64_t point_inputs() const {
    const int64_t kinds = (reads_direct() ? 1 : 0) + (reads_indirect() ? 1 : 0);
    return 12 + 3 * kinds * light_columns() + (light_variance ? light_columns() : 0) +
           (gloss ? kGlossColumns : 0);
  }
  /// Sides that light is told of by themselves.
  int64_t light_columns() const { return parts_sides() ? 2 : 1; }

  /// Marks its keys as known. @throws lte::Error for values out of range, naming the key.
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
