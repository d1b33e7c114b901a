// Local query decoder (the paper's section 3.4): irradiance at a surface point from the κ latents
// nearest to it.
//
// A layer's vector cross-attention is Σ_κ (W_q G − k_κ + P_κ) ⊙ (v_κ + P_κ) = W_q G ⊙ S1 + S2 with
// sums S1 and S2 that no query feature enters (docs/model.md, identity 1), so one pass over the
// neighbours serves all layers.
#pragma once

#include <cstdint>
#include <memory>
#include <tuple>
#include <vector>

#include "lte/nn/blocks/layer_norm.h"
#include "lte/nn/blocks/linear.h"
#include "lte/nn/blocks/mlp.h"
#include "lte/nn/config.h"
#include "lte/nn/encoder/attention_record.h"
#include "lte/ops/decoder_weights.h"
#include "lte/ops/knn.h"
#include "lte/ops/query_decoder.h"
#include "lte/tensor/module.h"
#include "lte/tensor/tensor.h"

namespace lte::nn {

/// One layer: G += W_o A with A = (W_q LN(G) ⊙ S1 + S2) / κ; G += FFN(LN(G)). Parameters:
/// `norm1.*`, `query.*`, `key.*`, `value.*`, `output.*`, `norm2.*` and `ffn.*`.
class QueryLayerImpl : public torch::nn::Module {
 public:
  QueryLayerImpl(int64_t latent, const ModelConfig& config);

  /// W_k F and W_v F, each [m, D].
  std::tuple<at::Tensor, at::Tensor> keys_and_values(const at::Tensor& latent);

  /// @param G   [Q, D]
  /// @param S1  [Q, D], the sum Σ (v + P), and S2 likewise Σ (P − k) ⊙ (v + P)
  /// @param neighbours  κ, by which the sums are divided
  at::Tensor forward(const at::Tensor& G, const at::Tensor& S1, const at::Tensor& S2,
                     int64_t neighbours);

  /// W_q LN(G), [Q, D], and what follows the attention: forward() in two steps.
  at::Tensor query(const at::Tensor& G) { return query_->forward(norm1_->forward(G)); }
  at::Tensor advance(const at::Tensor& G, const at::Tensor& attended);

  /// What forward() reads, in the precision of inference.
  ops::LayerWeights weights() const;

  const Linear& key() const { return key_; }
  const Linear& value() const { return value_; }

 private:
  double dropout_;
  LayerNorm norm1_{nullptr}, norm2_{nullptr};
  Linear query_{nullptr}, key_{nullptr}, value_{nullptr}, output_{nullptr};
  Mlp ffn_{nullptr};
};
TORCH_MODULE(QueryLayer);

/// Where points of surfaces lie and which way they face.
struct Surface {
  at::Tensor position;  ///< [n, 3] network space
  at::Tensor normal;    ///< [n, 3] unit; of models that read normals; else undefined will do
};

/// Queries of one scene, the latents of that scene, and the unit of the offsets between them.
struct SceneQueries {
  Surface query, anchor;
  double spacing;
};

/// What queries read of latents when answers are differentiated: keys and values of all layers,
/// each [L, m, D]; or where the decoder is one operator, that operator's table of both, in `keys`
/// alone.
struct LatentTables {
  at::Tensor keys, values;

  bool fused() const { return !values.defined(); }
};

/// The number whose softplus is `value` > 0: the bias of an output that starts there.
double softplus_inverse(double value);

/// The standard deviation that a head's answers start with before their softplus.
double first_gain(const ModelConfig& config);

/// Parameters: `point.*` (H, inputs -> D -> D), `gamma.*` (γ, 3 or 6 -> h -> D, shared by layers),
/// `layerI.*`, `norm.*`, `head.*` (D -> D -> 3, or as many as there are features).
class QueryDecoderImpl : public torch::nn::Module {
 public:
  /// @param latent    width of the latents
  /// @param features  0: it answers irradiance, [Q, 3]; else so many features of a query, which
  ///                  another module reads
  QueryDecoderImpl(int64_t latent, const ModelConfig& config, int64_t features = 0);

  /// Keys and values of all layers, each [L, m, D].
  std::tuple<at::Tensor, at::Tensor> keys_and_values(const at::Tensor& latent);

  /// What infer() reads of the latents, without gradients: ops::neighbour_table() of keys and
  /// values, made for some latents at a time, so that it exists once.
  at::Tensor table(const at::Tensor& latent);

  /// The latents nearest to each query: what no gradient passes through.
  struct Neighbourhood {
    at::Tensor index;  ///< [Q, κ] int64, κ = min(query_neighbours, m)
    /// [Q, κ, 3 or 6], what γ reads (lte/ops/pair_geometry.h): (p_j − p_κ) / spacing, limited to
    /// ±kOffsetLimit (lte/nn/constants.h), and by the configuration the cosines of the normals.
    at::Tensor geometry;
  };
  /// @param query   Q points
  /// @param anchor  the m latents, positions in float32
  Neighbourhood neighbourhood(const Surface& query, const Surface& anchor, double spacing) const;

  /// @param attributes  [Q, ModelConfig::query_inputs()]: position (network space), normal, albedo,
  ///                    and of models that read light the features of the light prior
  /// @return  [Q, 3] or [Q, features], non-negative, differentiable
  at::Tensor forward(const at::Tensor& attributes, const Neighbourhood& near,
                     const at::Tensor& keys, const at::Tensor& values);

  /// What the overload of forward() below reads of the latents of all scenes.
  LatentTables latent_tables(const at::Tensor& latent);

  /// forward() of the queries of several scenes, one after the other. On the CPU in float32 without
  /// dropout, one operator does it all (ops::query_decoder), which keeps next to nothing for the
  /// backward pass.
  at::Tensor forward(const at::Tensor& attributes, const std::vector<SceneQueries>& scenes,
                     const LatentTables& latents);

  /// What infer() makes at each call where it is not given: index() of the anchors, and packed().
  struct Prepared {
    const ops::KnnIndex* nearest = nullptr;
    const ops::PackedDecoder* weights = nullptr;
  };
  /// On the CPU alone.
  std::shared_ptr<const ops::KnnIndex> index(const at::Tensor& anchor) const;
  std::shared_ptr<const ops::PackedDecoder> packed() const;

  /// forward() from table(); float32, no gradients. Outside training everything is one operator.
  /// `query`, `anchor` and `spacing` are those of neighbourhood().
  at::Tensor infer(const at::Tensor& attributes, const Surface& query, const Surface& anchor,
                   double spacing, const at::Tensor& table, const Prepared& prepared);
  at::Tensor infer(const at::Tensor& attributes, const Surface& query, const Surface& anchor,
                   double spacing, const at::Tensor& table) {
    return infer(attributes, query, anchor, spacing, table, {});
  }

  /// What each layer takes from which latent, as the equations have it: nothing is factored, fused
  /// or summed over neighbours before it is kept.
  /// @param latent  [m, D]
  DecoderReading read(const at::Tensor& attributes, const SceneQueries& queries,
                      const at::Tensor& latent);

 private:
  /// Whether ops::query_decoder() differentiates what is computed from `latent`.
  bool trains_fused(const at::Tensor& latent) const;
  at::Tensor forward_fused(const at::Tensor& attributes, const std::vector<SceneQueries>& scenes,
                           const at::Tensor& table);
  at::Tensor nearest(const at::Tensor& query, const at::Tensor& anchor) const;
  /// S1 and S2, each [L, Q, D]. Many queries go in blocks that training recomputes, so that no
  /// [Q, κ, D] tensor exists.
  std::tuple<at::Tensor, at::Tensor> neighbour_sums(const Neighbourhood& near,
                                                    const at::Tensor& keys,
                                                    const at::Tensor& values);
  /// What ops::query_decoder_inference() reads.
  ops::DecoderWeights weights() const;
  at::Tensor run_layers(const at::Tensor& attributes, const at::Tensor& S1, const at::Tensor& S2,
                        int64_t neighbours);
  at::Tensor answer(const at::Tensor& G);

  int64_t neighbours_;
  double dropout_;
  bool reads_normals_;
  Mlp point_{nullptr}, gamma_{nullptr}, head_{nullptr};
  LayerNorm norm_{nullptr};
  std::vector<QueryLayer> layers_;
};
TORCH_MODULE(QueryDecoder);

}  // namespace lte::nn
