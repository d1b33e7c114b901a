// Decoders for ops::query_decoder_inference(), and the formula that it computes.
#pragma once

#include <cmath>
#include <functional>
#include <vector>

#include "lte/ops/decoder_weights.h"
#include "lte/ops/query_decoder.h"
#include "tests/ops/fixtures.h"

namespace lte::ops::test {

/// Weights of a decoder of C channels, L layers, A attributes, one hidden width and a γ of so many
/// inputs, from N(0, 1); matrices are divided by the root of their inputs.
inline DecoderWeights decoder_weights(int64_t A, int64_t C, int64_t L, int64_t hidden,
                                      int64_t gamma_inputs = kOffsetInputs) {
  uint64_t seed = 100;
  const auto vector = [&](int64_t size) { return normal({size}, seed++, at::kFloat); };
  const auto linear = [&](int64_t in, int64_t out) {
    const at::Tensor weight =
        normal({out, in}, seed++, at::kFloat) / std::sqrt(static_cast<double>(in));
    return LinearWeights{weight, vector(out)};
  };
  const auto norm = [&] {
    const at::Tensor gain = vector(C);
    return NormWeights{gain, vector(C)};
  };
  const auto perceptron = [&](int64_t in, int64_t out) {
    const LinearWeights first = linear(in, hidden);
    return PerceptronWeights{first, linear(hidden, out)};
  };
  DecoderWeights w;
  w.point = perceptron(A, C);
  w.gamma = perceptron(gamma_inputs, C);
  for (int64_t l = 0; l < L; ++l) {
    LayerWeights layer;
    layer.norm1 = norm();
    layer.query = linear(C, C);
    layer.output = linear(C, C);
    layer.norm2 = norm();
    layer.ffn = perceptron(C, C);
    w.layers.push_back(layer);
  }
  w.norm = norm();
  w.head = perceptron(C, 3);
  return w;
}

/// The weights after `change` of each matrix.
inline DecoderWeights with_matrices(DecoderWeights w,
                                    const std::function<at::Tensor(const at::Tensor&)>& change) {
  const auto perceptron = [&](PerceptronWeights& p) {
    p.hidden.weight = change(p.hidden.weight);
    p.output.weight = change(p.output.weight);
  };
  for (PerceptronWeights* p : {&w.point, &w.gamma, &w.head}) perceptron(*p);
  for (LayerWeights& layer : w.layers) {
    layer.query.weight = change(layer.query.weight);
    layer.output.weight = change(layer.output.weight);
    perceptron(layer.ffn);
  }
  return w;
}

/// All matrices in bfloat16 but γ's first, which the operator wants in float32, and `point.hidden`,
/// which has few inputs.
inline DecoderWeights in_bf16(const DecoderWeights& w) {
  DecoderWeights half = with_matrices(w, [](const at::Tensor& t) { return t.to(at::kBFloat16); });
  half.point.hidden = w.point.hidden;
  half.gamma.hidden = w.gamma.hidden;
  return half;
}

/// `w` on another device.
inline DecoderWeights on(at::DeviceType device, const DecoderWeights& w) {
  std::vector<at::Tensor> list = w.to_list();
  for (at::Tensor& t : list) t = t.to(device);
  return DecoderWeights::from_list(list, static_cast<int64_t>(w.layers.size()));
}

/// What the operator's contract says, in float64 and unfactored, from gathered copies of keys and
/// values [L, m, C]; the inputs of a layer whose weight is bfloat16 are rounded.
inline at::Tensor decoder_reference(const at::Tensor& attributes, const QueryNeighbourhood& near,
                                    const at::Tensor& keys, const at::Tensor& values,
                                    const DecoderWeights& w) {
  const auto wide = [](const at::Tensor& t) { return t.to(at::kDouble); };
  const auto dense = [&](const at::Tensor& x, const LinearWeights& l) {
    const bool rounds = l.weight.scalar_type() == at::kBFloat16;
    const at::Tensor read = rounds ? wide(x.to(at::kFloat).to(at::kBFloat16)) : x;
    return at::linear(read, wide(l.weight), wide(l.bias));
  };
  const auto perceptron = [&](const at::Tensor& x, const PerceptronWeights& p) {
    return dense(at::gelu(dense(x, p.hidden)), p.output);
  };
  const auto norm = [&](const at::Tensor& x, const NormWeights& n) {
    return at::layer_norm(x, {x.size(1)}, wide(n.gain), wide(n.bias));
  };
  const int64_t Q = near.index.size(0), K = near.index.size(1);
  const at::Tensor rows = near.index.reshape({-1});
  const auto gathered = [&](const at::Tensor& t) {
    return wide(t.index_select(0, rows)).view({Q, K, t.size(1)});
  };
  const at::Tensor offset =
      (near.position.unsqueeze(1) - near.anchor.index_select(0, rows).view({Q, K, 3}))
          .mul(near.scale)
          .clamp(-near.limit, near.limit);
  at::Tensor pair = wide(offset);
  if (near.normal.defined()) {
    const at::Tensor n = wide(near.normal).unsqueeze(1), n_k = gathered(near.anchor_normal);
    const auto dot = [](const at::Tensor& a, const at::Tensor& b) {
      return (a * b).sum(2, /*keepdim=*/true);
    };
    pair = at::cat({pair, dot(n, n_k), dot(n, pair), dot(n_k, pair)}, 2);
  }
  const at::Tensor P = perceptron(pair, w.gamma);
  at::Tensor G = perceptron(wide(attributes), w.point);
  for (size_t l = 0; l < w.layers.size(); ++l) {
    const LayerWeights& layer = w.layers[l];
    const auto at = static_cast<int64_t>(l);
    const at::Tensor query = dense(norm(G, layer.norm1), layer.query).unsqueeze(1);
    const at::Tensor attended =
        ((query - gathered(keys[at]) + P) * (gathered(values[at]) + P)).mean(1);
    G = G + dense(attended, layer.output);
    G = G + perceptron(norm(G, layer.norm2), layer.ffn);
  }
  return at::softplus(perceptron(norm(G, w.norm), w.head));
}

}  // namespace lte::ops::test
