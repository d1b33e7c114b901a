// Embeddings and scenes chosen to hurt arithmetic of few digits.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "lte/nn/decoder/query_decoder.h"
#include "lte/nn/model.h"

namespace lte::test {

/// A decoder with weights, latents and queries.
struct DecoderCase {
  nn::ModelConfig config;
  nn::QueryDecoder decoder{nullptr};
  at::Tensor position;    ///< [Q, 3] float32 in the unit cube
  at::Tensor attributes;  ///< [Q, 9]
  at::Tensor anchor;      ///< [m, 3]
  at::Tensor latent;      ///< [m, D]
  double spacing = 0.1;
};

struct DecoderAdversary {
  std::string name;
  double fp32_bound;  ///< of float32's difference from float64, relative in the Euclidean norm
  double bf16_bound;  ///< of bf16's difference from float32, likewise
  std::function<void(DecoderCase&)> arrange;
};

/// The first is random. Of the others, one latent or all are 10^4 times as large, as many points
/// coincide as there are neighbours, and latents and query features have no variance.
const std::vector<DecoderAdversary>& decoder_adversaries();
/// 70 queries, 100 latents, 32 neighbours, six layers, seed fixed.
DecoderCase make_decoder_case(const DecoderAdversary& adversary, int64_t channels);

/// Its fused inference, [Q, 3], in either precision.
at::Tensor decode_fused(DecoderCase& c, nn::Precision precision);
/// The pairwise equations in float64, with the first `layers` layers only.
at::Tensor decode_exactly(const DecoderCase& c, int64_t layers);
/// The same decoder cut after `layers` layers, weights kept.
DecoderCase cut(const DecoderCase& c, int64_t layers);

struct SceneAdversary {
  std::string name;
  double fp32_bound, bf16_bound;  ///< of the latents
  nn::PointSet points;
};
/// The first is random. The others have one lamp a million times as bright as the rest, coincident
/// points, and no features but positions.
std::vector<SceneAdversary> scene_adversaries(int64_t M);

}  // namespace lte::test
