// The whole network: scene points -> light transport embedding -> irradiance at query points (the
// paper's section 3).
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "lte/nn/blocks/precision.h"
#include "lte/nn/config.h"
#include "lte/nn/encoder/stage_health.h"
#include "lte/nn/points/light_prior.h"
#include "lte/nn/points/point_set.h"
#include "lte/nn/points/surfels.h"
#include "lte/ops/knn.h"
#include "lte/ops/query_decoder.h"
#include "lte/tensor/module.h"

namespace lte::nn {

struct DecoderReading;
struct EncoderAttention;

/// The light transport embedding of one scene: everything decode() needs.
struct Embedding {
  at::Tensor position;  ///< [m, 3] network space
  at::Tensor normal;    ///< [m, 3] of models that read normals; else undefined
  at::Tensor features;  ///< [m, D]
  at::Tensor origin;    ///< [3] world, b_min
  double scale = 1;     ///< s, metres
  /// Spacing of the m points, in network space: the last insertion distance of farthest point
  /// sampling.
  double spacing = 1;
  /// [3] float64 on the CPU, emission_scale() of the scene. The network reads emission divided by
  /// it, and decode() multiplies irradiance by it.
  at::Tensor emission_scale;
  /// ops::neighbour_table() of all layers, which encode() makes outside training; else undefined.
  at::Tensor table;
  at::Tensor radiance_table;  ///< the same of the radiance decoder, of models that have one
  /// What a call of few queries would spend its time on, made with the tables on the CPU: the
  /// neighbour search over `position`, and both decoders' weights. They belong to the table: it,
  /// too, is of the weights of then.
  std::shared_ptr<const ops::KnnIndex> nearest;
  std::shared_ptr<const ops::PackedDecoder> weights, radiance_weights;
  LightPrior prior;  ///< of models that read light
  Surfels surfels;   ///< of models that predict radiance
};

/// Several scenes that were embedded in one pass.
struct SceneBatch {
  std::vector<Embedding> scenes;
  at::Tensor features;  ///< [Σ m, D]; those of each scene are its rows
};

/// Where a scene lies in network space: p̂ = (p − origin) / scale.
struct Frame {
  at::Tensor origin;  ///< [3] world, at most every scene point; undefined: their least corner
  /// Metres; 0 stands for the model's s. More shrinks a scene wider than s for the network alone,
  /// which moves no irradiance that comes from surfaces.
  double scale = 0;
};

/// Whether a call looks at the values that it is given, which on a GPU waits for them. Unchecked:
/// check_points() and check_queries() have seen them, or the caller answers for them.
enum class Values { Checked, Unchecked };

struct DecodeOptions {
  /// false for queries that check_queries() has seen or the caller answers for: on a GPU nothing
  /// then waits for it.
  bool check_values = true;
  int64_t block = 0;  ///< queries at a time, at most; 0 for a size that runs fast
};

/// Parameters: `nne.*`, `encoder.*`, `decoder.*`, and, of models with a radiance decoder,
/// `radiance.*` (names in model files; do not rename).
class LightTransportModelImpl : public torch::nn::Module {
 public:
  explicit LightTransportModelImpl(const ModelConfig& config);

  /// Embeds one scene. Differentiable in the parameters; under NoGradGuard it also makes the
  /// decoder's table. In training mode the curve orders are drawn from `order_seed`; in evaluation
  /// they are fixed. `frame` is for callers whose scene's bounds are not those of its points.
  /// @param attention  gets what the blocks attend to (attention_record.h), at the cost of their
  ///                   convolutions a second time; null: nothing is recorded
  /// @throws c10::Error naming the first row that is not finite or out of range, a scene wider than
  ///         the frame's scale, or a point below the frame's origin
  Embedding encode(const PointSet& points, uint64_t order_seed = 0, const Frame& frame = {},
                   EncoderAttention* attention = nullptr);

  /// Embeds several scenes, at most kMaxScenes, in one pass, in which no scene sees another: what
  /// encode() gives for each, to rounding, in fewer and larger operations.
  /// @throws c10::Error as encode(); lte::Error if a scene is too fine (make_encoder_plan())
  SceneBatch encode_batch(const std::vector<PointSet>& scenes,
                          const std::vector<uint64_t>& order_seeds,
                          Values values = Values::Checked);

  /// What each stage of the encoder carries for a scene, in the order of the network.
  /// @throws c10::Error as encode()
  std::vector<StageHealth> stage_health(const PointSet& points);

  /// The arithmetic of encode() and decode() without gradients from now on, on a CPU as on a GPU.
  /// It rounds the weights that there are now: call it again when they have changed.
  void set_precision(Precision precision);

  /// What the decoder takes from which latent on the way to decode_normalized(), by layer: for few
  /// queries, as it keeps [L, Q, κ, D] weights.
  DecoderReading read(const Embedding& embedding, const QuerySet& queries);

  /// Irradiance over the emission scale: what the loss sees.
  /// @return [Q, 3], non-negative
  at::Tensor decode_normalized(const Embedding& embedding, const QuerySet& queries);

  /// The same for each scene of a batch, differentiable.
  std::vector<at::Tensor> decode_normalized(const SceneBatch& batch,
                                            const std::vector<QuerySet>& queries,
                                            Values values = Values::Checked);

  /// Irradiance in W/m², [Q, 3]. Works through queries in blocks, so memory does not grow with Q
  /// beyond the output. Independent of block size and of the other queries to rounding.
  at::Tensor decode(const Embedding& embedding, const QuerySet& queries,
                    const DecodeOptions& options = {});

  /// Incident radiance L by direction as the loss sees it: π L over the emission scale. That is the
  /// irradiance of a sky which is L everywhere, so it is of the order of decode_normalized()'s.
  /// Differentiable.
  ///
  /// @param directions  of each scene [Q, N, 3] world, unit, away from the surface
  /// @return  of each scene [Q, N, 3], non-negative
  /// @throws c10::Error as check_directions(), or if the model has no radiance decoder
  std::vector<at::Tensor> decode_radiance_normalized(const SceneBatch& batch,
                                                     const std::vector<QuerySet>& queries,
                                                     const std::vector<at::Tensor>& directions);

  /// Incident radiance in W sr^-1 m^-2, [Q, N, 3], of light that bounced at least once. Works
  /// through queries in blocks.
  /// @param directions  [Q, N, 3] world, unit, away from the surface
  /// @throws c10::Error as decode_radiance_normalized()
  at::Tensor decode_radiance(const Embedding& embedding, const QuerySet& queries,
                             const at::Tensor& directions, const DecodeOptions& options = {});

  /// Makes what decode() and decode_radiance() read, of features in float32: the tables, unless
  /// they are there, and on the CPU what stands beside them in the embedding.
  void make_tables(Embedding* embedding);

  const ModelConfig& config() const { return config_; }

 private:
  at::Tensor radiance_of_block(const Embedding& embedding, const QuerySet& queries,
                               const at::Tensor& directions);
  Embedding place(const PointSet& points, const Frame& frame, Values values, at::Tensor* position,
                  at::Tensor* attributes) const;
  void add_light(const PointSet& points, const at::Tensor& position,
                 std::vector<at::Tensor>* columns, Embedding* embedding) const;
  void add_surfels(const PointSet& points, const at::Tensor& position, Embedding* embedding);
  SceneBatch encode(const std::vector<PointSet>& scenes, const std::vector<uint64_t>& order_seeds,
                    const Frame& frame, EncoderRecorder* recorder, Values values = Values::Checked);

  ModelConfig config_;
  struct Parts;
  std::shared_ptr<Parts> parts_;
};
TORCH_MODULE(LightTransportModel);

/// The arithmetic of all of a network's dense layers and convolutions, as
/// LightTransportModel::set_precision().
void set_precision(torch::nn::Module& network, Precision precision);

/// The arithmetic of all of a network's dense layers and convolutions where gradients are computed,
/// from now on: Bf16 rounds what their products read, forward and backward, and leaves
/// weights, sums, results and gradients in float32. On CUDA attention too. Without gradients
/// nothing changes.
void set_autocast(torch::nn::Module& network, Precision precision);

}  // namespace lte::nn
