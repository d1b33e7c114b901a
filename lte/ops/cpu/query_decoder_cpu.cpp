// The query decoder on the CPU. A thread takes a tile of queries through everything: positions,
// sums over neighbours, all layers, the head. A tile's intermediates stay in the second-level
// cache, and a layer's weights are read from the third once a tile.
#include <algorithm>
#include <cmath>
#include <vector>

#include <ATen/Parallel.h>
#include <ATen/ops/empty.h>
#include <torch/library.h>

#include "lte/ops/arguments.h"
#include "lte/ops/cpu/packed_linear.h"

namespace lte::ops {
namespace {

constexpr int64_t kTile = 96;     ///< queries of a tile; a multiple of the kernels' rows
constexpr int64_t kSubtile = 16;  ///< queries whose γ activations, 128 KiB, exist at once
constexpr int64_t kPair = 2 * kBlock;
constexpr int64_t kFixedWeights = 14, kLayerWeights = 12;  ///< tensors of all, and of each layer

/// LayerNorm's gain and bias, zero past the last channel.
struct PackedNorm {
  std::vector<float> gain, bias;

  PackedNorm(const at::Tensor& g, const at::Tensor& b)
      : gain(static_cast<size_t>(blocks_of(g.size(0)) * kBlock)), bias(gain.size()) {
    const at::Tensor dense_gain = g.contiguous(), dense_bias = b.contiguous();
    std::copy_n(dense_gain.const_data_ptr<float>(), g.size(0), gain.begin());
    std::copy_n(dense_bias.const_data_ptr<float>(), g.size(0), bias.begin());
  }

  void apply(const Tile& x, int64_t rows, int64_t channels, Tile& out) const {
    dense_kernels().layer_norm(x.panel(0), rows, x.panel_stride(), channels, gain.data(),
                               bias.data(), out.panel(0));
  }
};

struct PackedLayer {
  PackedNorm norm1;
  PackedLinear query, output;
  PackedNorm norm2;
  PackedLinear hidden, last;
};

struct PackedDecoder {
  PackedLinear point_hidden, point_output;
  std::vector<float> gamma_hidden;  ///< [H, 4]: three weights and the bias
  PackedLinear gamma_output;
  std::vector<PackedLayer> layers;
  PackedNorm norm;
  PackedLinear head_hidden, head_output;
};

void check_shape(const at::Tensor& t, at::IntArrayRef shape, const char* name) {
  TORCH_CHECK(t.sizes() == shape && t.scalar_type() == at::kFloat,
              "query_decoder_inference: ", name, " must be ", shape, " float32, got ", t.sizes(),
              " ", t.scalar_type());
}

/// In float32, or with a matrix of bfloat16.
PackedLinear pack(at::TensorList w, size_t at, int64_t inputs, int64_t outputs, const char* name) {
  TORCH_CHECK(w[at].sizes() == at::IntArrayRef({outputs, inputs}) &&
                  (w[at].scalar_type() == at::kFloat || w[at].scalar_type() == at::kBFloat16),
              "query_decoder_inference: ", name, " must be [", outputs, ", ", inputs,
              "] float32 or bfloat16, got ", w[at].sizes(), " ", w[at].scalar_type());
  check_shape(w[at + 1], {outputs}, name);
  return {w[at], w[at + 1]};
}

PackedNorm pack_norm(at::TensorList w, size_t at, int64_t channels, const char* name) {
  check_shape(w[at], {channels}, name);
  check_shape(w[at + 1], {channels}, name);
  return {w[at], w[at + 1]};
}

std::vector<float> pack_gamma_hidden(at::TensorList w, size_t at) {
  const int64_t H = w[at].size(0);
  check_shape(w[at], {H, 3}, "gamma.hidden");
  check_shape(w[at + 1], {H}, "gamma.hidden");
  std::vector<float> packed(static_cast<size_t>(4 * H));
  const at::Tensor weight = w[at].contiguous(), bias = w[at + 1].contiguous();
  for (int64_t h = 0; h < H; ++h) {
    std::copy_n(weight.const_data_ptr<float>() + 3 * h, 3, packed.begin() + 4 * h);
    packed[4 * h + 3] = bias.const_data_ptr<float>()[h];
  }
  return packed;
}

PackedDecoder pack_decoder(at::TensorList w, int64_t attributes, int64_t L) {
  TORCH_CHECK(static_cast<int64_t>(w.size()) == kFixedWeights + L * kLayerWeights,
              "query_decoder_inference: ", L, " layers have ", kFixedWeights + L * kLayerWeights,
              " weights, got ", w.size());
  for (const size_t i : {0, 4, 6}) {
    TORCH_CHECK(w[i].dim() == 2, "query_decoder_inference: weight ", i, " must be a matrix, got ",
                w[i].sizes());
  }
  const int64_t C = w[6].size(0), H = w[4].size(0), point_hidden = w[0].size(0);
  std::vector<PackedLayer> layers;
  for (int64_t l = 0; l < L; ++l) {
    const auto at = static_cast<size_t>(8 + l * kLayerWeights);
    TORCH_CHECK(w[at + 8].dim() == 2, "query_decoder_inference: ffn.hidden must be a matrix");
    const int64_t ffn = w[at + 8].size(0);
    layers.push_back({pack_norm(w, at, C, "norm1"), pack(w, at + 2, C, C, "query"),
                      pack(w, at + 4, C, C, "output"), pack_norm(w, at + 6, C, "norm2"),
                      pack(w, at + 8, C, ffn, "ffn.hidden"),
                      pack(w, at + 10, ffn, C, "ffn.output")});
  }
  const auto end = static_cast<size_t>(8 + L * kLayerWeights);
  TORCH_CHECK(w[end + 2].dim() == 2 && w[end + 4].dim() == 2,
              "query_decoder_inference: the head's weights must be matrices");
  const int64_t head = w[end + 2].size(0);
  return {pack(w, 0, attributes, point_hidden, "point.hidden"),
          pack(w, 2, point_hidden, C, "point.output"),
          pack_gamma_hidden(w, 4),
          pack(w, 6, H, C, "gamma.output"),
          std::move(layers),
          pack_norm(w, end, C, "norm"),
          pack(w, end + 2, C, head, "head.hidden"),
          pack(w, end + 4, head, w[end + 4].size(0), "head.output")};
}

/// What all tiles read.
struct Work {
  const PackedDecoder& net;
  int64_t attributes, K, L, C;
  const float *attribute, *position, *anchor, *table;
  const int64_t* index;
  float scale, limit;
  float* out;
};

/// One thread's working memory.
class TileDecoder {
 public:
  explicit TileDecoder(const Work& work)
      : work_(work),
        blocks_(blocks_of(work.C)),
        H_(work.net.gamma_output.inputs),
        pairs_(blocks_of(work.K) * kBlock),
        input_(kTile, work.attributes),
        features_(kTile, work.C),
        normed_(kTile, work.C),
        attended_(kTile, work.C),
        hidden_(kTile, kPanel),
        answer_(kTile, work.net.head_output.outputs),
        sums_(static_cast<size_t>(kTile * blocks_ * work.L * kPair)),
        offset_(static_cast<size_t>(3 * pairs_)),
        activation_(work.net.gamma_output.in_bf16() ? 0
                                                    : static_cast<size_t>(kSubtile * H_ * pairs_)),
        rounded_(work.net.gamma_output.in_bf16()
                     ? static_cast<size_t>(kSubtile * work.net.gamma_output.input_pairs() * pairs_)
                     : 0),
        pair_position_(static_cast<size_t>(pairs_ * kBlock)) {}

  /// Queries [first, first + rows), at most kTile.
  void run(int64_t first, int64_t rows) {
    const PackedDecoder& net = work_.net;
    for (int64_t i = 0; i < rows; ++i) {
      const float* from = work_.attribute + (first + i) * work_.attributes;
      for (int64_t a = 0; a < work_.attributes; ++a) {
        input_.panel(a / kPanel)[i * kPanel + a % kPanel] = from[a];
      }
    }
    perceptron(net.point_hidden, net.point_output, input_, rows, false, hidden_, features_);
    for (int64_t i = 0; i < rows; i += kSubtile) {
      sum_neighbours(first + i, std::min(kSubtile, rows - i),
                     sums_.data() + i * blocks_ * work_.L * kPair);
    }
    for (int64_t l = 0; l < work_.L; ++l) run_layer(net.layers[l], l, rows);
    net.norm.apply(features_, rows, work_.C, normed_);
    perceptron(net.head_hidden, net.head_output, normed_, rows, false, hidden_, answer_);
    write(first, rows);
  }

 private:
  void sum_neighbours(int64_t first, int64_t count, float* out) {
    const PackedLinear& gamma = work_.net.gamma_output;
    for (int64_t i = 0; i < count; ++i) {
      const float* q = work_.position + 3 * (first + i);
      const int64_t* near = work_.index + (first + i) * work_.K;
      for (int64_t j = 0; j < work_.K; ++j) {
        const float* p = work_.anchor + 3 * near[j];
        for (int axis = 0; axis < 3; ++axis) {
          const float offset = (q[axis] - p[axis]) * work_.scale;
          offset_[axis * pairs_ + j] = std::clamp(offset, -work_.limit, work_.limit);
        }
      }
      if (gamma.in_bf16()) {
        bf16_kernels().hidden_positions(offset_.data(), pairs_, work_.net.gamma_hidden.data(), H_,
                                        rounded_.data() + i * gamma.input_pairs() * pairs_);
      } else {
        dense_kernels().hidden_positions(offset_.data(), pairs_, work_.net.gamma_hidden.data(), H_,
                                         activation_.data() + i * H_ * pairs_);
      }
    }
    if (gamma.in_bf16()) {
      bf16_kernels().projected_sums(work_.table, blocks_, work_.L, work_.index + first * work_.K,
                                    count, work_.K, rounded_.data(), gamma.input_pairs(),
                                    gamma.pairs.data(), gamma.bias.data(), pair_position_.data(),
                                    out);
      return;
    }
    sum_kernels<float>().projected_sums(
        work_.table, blocks_, work_.L, work_.index + first * work_.K, count, work_.K,
        activation_.data(), H_, gamma.weight.data(), gamma.bias.data(), pair_position_.data(), out);
  }

  void run_layer(const PackedLayer& layer, int64_t l, int64_t rows) {
    layer.norm1.apply(features_, rows, work_.C, normed_);
    dense(layer.query, normed_, rows, false, attended_);
    for (int64_t p = 0; p < panels_of(work_.C); ++p) {
      const int64_t first = p * (kPanel / kBlock);
      dense_kernels().attend(attended_.panel(p), rows, std::min(blocks_ - first, kPanel / kBlock),
                             sums_.data() + (first * work_.L + l) * kPair,
                             blocks_ * work_.L * kPair, work_.L * kPair,
                             1 / static_cast<float>(work_.K), attended_.panel(p));
    }
    dense(layer.output, attended_, rows, true, features_);
    layer.norm2.apply(features_, rows, work_.C, normed_);
    perceptron(layer.hidden, layer.last, normed_, rows, true, hidden_, features_);
  }

  void write(int64_t first, int64_t rows) {
    const int64_t outputs = work_.net.head_output.outputs;
    for (int64_t i = 0; i < rows; ++i) {
      for (int64_t o = 0; o < outputs; ++o) {
        const float x = answer_.panel(o / kPanel)[i * kPanel + o % kPanel];
        // Softplus as LibTorch has it: the identity where it is that to rounding.
        work_.out[(first + i) * outputs + o] = x > 20 ? x : std::log1p(std::exp(x));
      }
    }
  }

  const Work& work_;
  int64_t blocks_, H_, pairs_;
  Tile input_, features_, normed_, attended_, hidden_, answer_;
  std::vector<float> sums_;           ///< [kTile, blocks, L, 2, kBlock]
  std::vector<float> offset_;         ///< [3, pairs] of one query
  std::vector<float> activation_;     ///< [kSubtile, H, pairs]
  std::vector<uint32_t> rounded_;     ///< [kSubtile, ⌈H / 2⌉, pairs] of bfloat16
  std::vector<float> pair_position_;  ///< [pairs, kBlock]
};

at::Tensor query_decoder_inference_cpu(const at::Tensor& any_attributes,
                                       const at::Tensor& any_position, const at::Tensor& any_anchor,
                                       const at::Tensor& any_index, double scale, double limit,
                                       const at::Tensor& table, at::TensorList weights) {
  const char* op = "query_decoder_inference";
  const at::Tensor attributes = any_attributes.contiguous(), position = any_position.contiguous(),
                   anchor = any_anchor.contiguous(), index = any_index.contiguous();
  check_triples(position, at::kFloat, op, "position");
  check_triples(anchor, at::kFloat, op, "anchor");
  const int64_t Q = position.size(0), m = anchor.size(0);
  TORCH_CHECK(table.dim() == 5 && table.size(0) == m && table.size(3) == 2 &&
                  table.size(4) == kBlock && table.is_contiguous() &&
                  table.scalar_type() == at::kFloat,
              op, ": table must come from neighbour_table() for ", m, " latents in float32, got ",
              table.sizes(), " ", table.scalar_type());
  TORCH_CHECK(
      attributes.dim() == 2 && attributes.size(0) == Q && attributes.scalar_type() == at::kFloat,
      op, ": attributes must be [", Q, ", A] float32, got ", attributes.sizes(), " ",
      attributes.scalar_type());
  check_neighbours(index, Q, m, op);
  const PackedDecoder net = pack_decoder(weights, attributes.size(1), table.size(2));
  const int64_t C = net.gamma_output.outputs;
  TORCH_CHECK(table.size(1) == blocks_of(C), op, ": table has ", table.size(1),
              " blocks of channels, the weights ", blocks_of(C));
  at::Tensor out = at::empty({Q, net.head_output.outputs}, attributes.options());
  const Work work{net,
                  attributes.size(1),
                  index.size(1),
                  table.size(2),
                  C,
                  attributes.const_data_ptr<float>(),
                  position.const_data_ptr<float>(),
                  anchor.const_data_ptr<float>(),
                  table.const_data_ptr<float>(),
                  index.const_data_ptr<int64_t>(),
                  static_cast<float>(scale),
                  static_cast<float>(limit),
                  out.data_ptr<float>()};
  at::parallel_for(0, (Q + kTile - 1) / kTile, 1, [&](int64_t begin, int64_t end) {
    TileDecoder decoder(work);
    for (int64_t t = begin; t < end; ++t) {
      decoder.run(t * kTile, std::min(kTile, Q - t * kTile));
    }
  });
  return out;
}

}  // namespace
}  // namespace lte::ops

TORCH_LIBRARY_IMPL(lte, CPU, m) {
  m.impl("query_decoder_inference", lte::ops::query_decoder_inference_cpu);
}
