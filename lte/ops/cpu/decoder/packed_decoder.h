// The query decoder's weights as its tiles read them, and what its pairs are.
#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include "lte/ops/cpu/dense/tile_layers.h"
#include "lte/ops/query_decoder_args.h"
#include "lte/tensor/tensor.h"

namespace lte::ops {

struct PackedLayer {
  PackedNorm norm1;
  PackedLinear query, output;
  PackedNorm norm2;
  PackedLinear hidden, last;
};

struct PackedDecoder {
  DecoderShape shape;
  PackedLinear point_hidden, point_output;
  /// [H, F + 1]; where γ's output is in bfloat16 [F + 1, 2 hidden_pairs(H)] instead.
  std::vector<float> gamma_hidden;
  PackedLinear gamma_output;
  std::vector<PackedLayer> layers;
  PackedNorm norm;
  PackedLinear head_hidden, head_output;
};

/// γ's first layer: weights, then biases, of PackedDecoder's shapes.
inline std::vector<float> pack_gamma_hidden(const LinearWeights& w, bool bf16) {
  const int64_t H = w.outputs(), F = w.inputs();
  const int64_t of_output = bf16 ? 1 : F + 1, of_input = bf16 ? 2 * hidden_pairs(H) : 1;
  std::vector<float> packed(static_cast<size_t>(bf16 ? (F + 1) * of_input : H * of_output));
  const at::Tensor weight = w.weight.contiguous(), bias = w.bias.contiguous();
  for (int64_t h = 0; h < H; ++h) {
    const auto row = packed.begin() + h * of_output;
    for (int64_t f = 0; f < F; ++f) row[f * of_input] = weight.const_data_ptr<float>()[h * F + f];
    row[F * of_input] = bias.const_data_ptr<float>()[h];
  }
  return packed;
}

inline PackedDecoder pack(const DecoderWeights& w) {
  const auto linear = [](const LinearWeights& l) { return PackedLinear(l.weight, l.bias); };
  const auto norm = [](const NormWeights& n) { return PackedNorm(n.gain, n.bias); };
  std::vector<PackedLayer> layers;
  for (const LayerWeights& layer : w.layers) {
    layers.push_back({norm(layer.norm1), linear(layer.query), linear(layer.output),
                      norm(layer.norm2), linear(layer.ffn.hidden), linear(layer.ffn.output)});
  }
  return {{w.point.hidden.inputs(), w.gamma.output.outputs(), w.gamma.hidden.inputs(),
           w.gamma.hidden.outputs(), w.head.output.outputs()},
          linear(w.point.hidden),
          linear(w.point.output),
          pack_gamma_hidden(w.gamma.hidden, w.gamma.output.weight.scalar_type() == at::kBFloat16),
          linear(w.gamma.output),
          std::move(layers),
          norm(w.norm),
          linear(w.head.hidden),
          linear(w.head.output)};
}

/// The arguments of a decoder, contiguous.
struct DecoderInputs {
  at::Tensor attributes, table;
  QueryNeighbourhood near;
  DecoderSizes sizes;

  DecoderInputs(const at::Tensor& any_attributes, const QueryNeighbourhood& any,
                const at::Tensor& of_latents, const DecoderWeights& weights)
      : DecoderInputs(any_attributes, any, of_latents,
                      check_query_decoder_args(any_attributes, any, of_latents, weights)) {}

  /// @param checked  of these arguments
  DecoderInputs(const at::Tensor& any_attributes, const QueryNeighbourhood& any,
                const at::Tensor& of_latents, const DecoderSizes& checked)
      : attributes(any_attributes.contiguous()), table(of_latents), near(any), sizes(checked) {
    for (at::Tensor* t :
         {&near.position, &near.anchor, &near.index, &near.normal, &near.anchor_normal}) {
      if (t->defined()) *t = t->contiguous();
    }
  }
};

/// What γ reads of pairs.
class PairReader {
 public:
  explicit PairReader(const QueryNeighbourhood& near)
      : position_(near.position.const_data_ptr<float>()),
        anchor_(near.anchor.const_data_ptr<float>()),
        normal_(data(near.normal)),
        anchor_normal_(data(near.anchor_normal)),
        scale_(static_cast<float>(near.scale)),
        limit_(static_cast<float>(near.limit)) {}

  /// Input f of query q and a latent goes to out[f * stride].
  void read(int64_t q, int64_t latent, float* out, int64_t stride) const {
    const float *here = position_ + 3 * q, *there = anchor_ + 3 * latent;
    for (int axis = 0; axis < 3; ++axis) {
      const float offset = (here[axis] - there[axis]) * scale_;
      out[axis * stride] = std::clamp(offset, -limit_, limit_);
    }
    if (normal_ != nullptr) read_normals(normal_ + 3 * q, anchor_normal_ + 3 * latent, out, stride);
  }

 private:
  static const float* data(const at::Tensor& t) {
    return t.defined() ? t.const_data_ptr<float>() : nullptr;
  }

  /// Cosines of the normals with each other and with the offset.
  static void read_normals(const float* here, const float* there, float* out, int64_t stride) {
    float facing = 0, above = 0, ahead = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const float offset = out[axis * stride];
      facing += here[axis] * there[axis];
      above += here[axis] * offset;
      ahead += there[axis] * offset;
    }
    out[3 * stride] = facing;
    out[4 * stride] = above;
    out[5 * stride] = ahead;
  }

  const float *position_, *anchor_;
  const float *normal_, *anchor_normal_;  ///< nullptr where γ reads the offset alone
  float scale_, limit_;
};

}  // namespace lte::ops
