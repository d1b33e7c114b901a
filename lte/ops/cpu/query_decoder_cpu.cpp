// The query decoder on the CPU. A thread takes a tile of queries through everything: positions,
// sums over neighbours, all layers, the head. A tile's intermediates stay in the second-level
// cache, and a layer's weights are read from the third once a tile.
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include <ATen/Parallel.h>
#include <ATen/ops/empty.h>
#include <torch/library.h>

#include "lte/ops/cpu/packed_linear.h"
#include "lte/ops/query_decoder_args.h"

namespace lte::ops {
namespace {

constexpr int64_t kTile = 96;     ///< queries of a tile; a multiple of the kernels' rows
constexpr int64_t kSubtile = 16;  ///< queries whose activations of γ, 128 KiB, exist at once
constexpr int64_t kPair = 2 * kBlock;

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
  std::vector<float> gamma_hidden;  ///< [H, F + 1]
  PackedLinear gamma_output;
  std::vector<PackedLayer> layers;
  PackedNorm norm;
  PackedLinear head_hidden, head_output;
};

/// γ's first layer as [H, F + 1]: a row of weights, then the bias.
std::vector<float> pack_gamma_hidden(const LinearWeights& w) {
  const int64_t H = w.outputs(), F = w.inputs();
  std::vector<float> packed(static_cast<size_t>((F + 1) * H));
  const at::Tensor weight = w.weight.contiguous(), bias = w.bias.contiguous();
  for (int64_t h = 0; h < H; ++h) {
    const auto row = packed.begin() + (F + 1) * h;
    std::copy_n(weight.const_data_ptr<float>() + F * h, F, row);
    row[F] = bias.const_data_ptr<float>()[h];
  }
  return packed;
}

PackedDecoder pack(const DecoderWeights& w) {
  const auto linear = [](const LinearWeights& l) { return PackedLinear(l.weight, l.bias); };
  const auto norm = [](const NormWeights& n) { return PackedNorm(n.gain, n.bias); };
  std::vector<PackedLayer> layers;
  for (const LayerWeights& layer : w.layers) {
    layers.push_back({norm(layer.norm1), linear(layer.query), linear(layer.output),
                      norm(layer.norm2), linear(layer.ffn.hidden), linear(layer.ffn.output)});
  }
  return {linear(w.point.hidden), linear(w.point.output), pack_gamma_hidden(w.gamma.hidden),
          linear(w.gamma.output), std::move(layers),      norm(w.norm),
          linear(w.head.hidden),  linear(w.head.output)};
}

/// What all tiles read.
struct Work {
  const PackedDecoder& net;
  DecoderSizes sizes;
  const float *attribute, *position, *anchor;
  const float *normal, *anchor_normal;  ///< nullptr where γ reads the offset alone
  const float* table;
  const int64_t* index;
  float scale, limit;
  float* out;
};

/// One thread's working memory.
class TileDecoder {
 public:
  explicit TileDecoder(const Work& work)
      : work_(work),
        K_(work.sizes.neighbours),
        L_(work.sizes.layers),
        C_(work.sizes.channels),
        H_(work.sizes.gamma_hidden),
        blocks_(blocks_of(C_)),
        pairs_(blocks_of(K_) * kBlock),
        input_(kTile, work.sizes.attributes),
        features_(kTile, C_),
        normed_(kTile, C_),
        attended_(kTile, C_),
        hidden_(kTile, kPanel),
        answer_(kTile, work.sizes.outputs),
        sums_(static_cast<size_t>(kTile * blocks_ * L_ * kPair)),
        geometry_(static_cast<size_t>(work.sizes.gamma_inputs * pairs_)),
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
      const float* from = work_.attribute + (first + i) * work_.sizes.attributes;
      for (int64_t a = 0; a < work_.sizes.attributes; ++a) {
        input_.panel(a / kPanel)[i * kPanel + a % kPanel] = from[a];
      }
    }
    perceptron(net.point_hidden, net.point_output, input_, rows, false, hidden_, features_);
    for (int64_t i = 0; i < rows; i += kSubtile) {
      sum_neighbours(first + i, std::min(kSubtile, rows - i),
                     sums_.data() + i * blocks_ * L_ * kPair);
    }
    for (int64_t l = 0; l < L_; ++l) run_layer(net.layers[l], l, rows);
    net.norm.apply(features_, rows, C_, normed_);
    perceptron(net.head_hidden, net.head_output, normed_, rows, false, hidden_, answer_);
    write(first, rows);
  }

 private:
  /// Fills geometry_ with what γ reads of query q and its neighbours.
  void measure_pairs(int64_t q) {
    const float* at = work_.position + 3 * q;
    const int64_t* near = work_.index + q * K_;
    for (int64_t j = 0; j < K_; ++j) {
      const float* p = work_.anchor + 3 * near[j];
      for (int axis = 0; axis < 3; ++axis) {
        const float offset = (at[axis] - p[axis]) * work_.scale;
        geometry_[axis * pairs_ + j] = std::clamp(offset, -work_.limit, work_.limit);
      }
      if (work_.normal != nullptr) measure_normals(work_.normal + 3 * q, near[j], j);
    }
  }

  /// Cosines of the normals with each other and with the offset of pair j.
  void measure_normals(const float* normal, int64_t latent, int64_t j) {
    const float* there = work_.anchor_normal + 3 * latent;
    float facing = 0, above = 0, ahead = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const float offset = geometry_[axis * pairs_ + j];
      facing += normal[axis] * there[axis];
      above += normal[axis] * offset;
      ahead += there[axis] * offset;
    }
    geometry_[3 * pairs_ + j] = facing;
    geometry_[4 * pairs_ + j] = above;
    geometry_[5 * pairs_ + j] = ahead;
  }

  void sum_neighbours(int64_t first, int64_t count, float* out) {
    const PackedLinear& gamma = work_.net.gamma_output;
    for (int64_t i = 0; i < count; ++i) {
      measure_pairs(first + i);
      const PairGeometry geometry{geometry_.data(), work_.sizes.gamma_inputs, pairs_};
      if (gamma.in_bf16()) {
        bf16_kernels().hidden_positions(geometry, work_.net.gamma_hidden.data(), H_,
                                        rounded_.data() + i * gamma.input_pairs() * pairs_);
      } else {
        dense_kernels().hidden_positions(geometry, work_.net.gamma_hidden.data(), H_,
                                         activation_.data() + i * H_ * pairs_);
      }
    }
    const NeighbourTable<float> near{work_.table, blocks_, L_, work_.index + first * K_, count, K_};
    if (gamma.in_bf16()) {
      bf16_kernels().projected_sums(near,
                                    {rounded_.data(), gamma.input_pairs(), gamma.pairs.data(),
                                     gamma.bias.data(), pair_position_.data()},
                                    out);
    } else {
      sum_kernels<float>().projected_sums(
          near,
          {activation_.data(), H_, gamma.weight.data(), gamma.bias.data(), pair_position_.data()},
          out);
    }
  }

  void run_layer(const PackedLayer& layer, int64_t l, int64_t rows) {
    layer.norm1.apply(features_, rows, C_, normed_);
    dense(layer.query, normed_, rows, false, attended_);
    for (int64_t p = 0; p < panels_of(C_); ++p) {
      const int64_t first = p * (kPanel / kBlock);
      dense_kernels().attend({attended_.panel(p), rows, std::min(blocks_ - first, kPanel / kBlock),
                              sums_.data() + (first * L_ + l) * kPair, blocks_ * L_ * kPair,
                              L_ * kPair, 1 / static_cast<float>(K_), attended_.panel(p)});
    }
    dense(layer.output, attended_, rows, true, features_);
    layer.norm2.apply(features_, rows, C_, normed_);
    perceptron(layer.hidden, layer.last, normed_, rows, true, hidden_, features_);
  }

  void write(int64_t first, int64_t rows) {
    const int64_t outputs = work_.sizes.outputs;
    for (int64_t i = 0; i < rows; ++i) {
      for (int64_t o = 0; o < outputs; ++o) {
        const float x = answer_.panel(o / kPanel)[i * kPanel + o % kPanel];
        // Softplus as LibTorch has it: the identity where it is that to rounding.
        work_.out[(first + i) * outputs + o] = x > 20 ? x : std::log1p(std::exp(x));
      }
    }
  }

  const Work& work_;
  int64_t K_, L_, C_, H_;  ///< work's sizes
  int64_t blocks_;         ///< of channels
  int64_t pairs_;          ///< K, rounded up to whole blocks
  Tile input_, features_, normed_, attended_, hidden_, answer_;
  std::vector<float> sums_;           ///< [kTile, blocks, L, 2, kBlock]
  std::vector<float> geometry_;       ///< [F, pairs] of one query
  std::vector<float> activation_;     ///< [kSubtile, H, pairs]
  std::vector<uint32_t> rounded_;     ///< [kSubtile, ⌈H / 2⌉, pairs], in bfloat16 instead
  std::vector<float> pair_position_;  ///< [pairs, kBlock]
};

at::Tensor query_decoder_inference_cpu(const at::Tensor& any_attributes,
                                       const at::Tensor& any_position, const at::Tensor& any_anchor,
                                       const at::Tensor& any_index, double scale, double limit,
                                       const std::optional<at::Tensor>& any_normal,
                                       const std::optional<at::Tensor>& any_anchor_normal,
                                       const at::Tensor& table, at::TensorList list) {
  const DecoderWeights weights = DecoderWeights::from_list(list, table_layers(table));
  const QueryNeighbourhood near{any_position,
                                any_anchor,
                                any_index,
                                scale,
                                limit,
                                any_normal.value_or(at::Tensor()),
                                any_anchor_normal.value_or(at::Tensor())};
  const DecoderSizes sizes = check_query_decoder_args(any_attributes, near, table, weights);
  const auto dense_or_none = [](const at::Tensor& t) {
    return t.defined() ? t.contiguous() : at::Tensor();
  };
  const auto data = [](const at::Tensor& t) {
    return t.defined() ? t.const_data_ptr<float>() : nullptr;
  };
  const at::Tensor attributes = any_attributes.contiguous(), position = any_position.contiguous(),
                   anchor = any_anchor.contiguous(), index = any_index.contiguous(),
                   normal = dense_or_none(near.normal),
                   anchor_normal = dense_or_none(near.anchor_normal);
  const int64_t Q = sizes.queries;
  const PackedDecoder net = pack(weights);
  at::Tensor out = at::empty({Q, sizes.outputs}, attributes.options());
  const Work work{net,
                  sizes,
                  attributes.const_data_ptr<float>(),
                  position.const_data_ptr<float>(),
                  anchor.const_data_ptr<float>(),
                  data(normal),
                  data(anchor_normal),
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
