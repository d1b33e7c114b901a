// The query decoder on the CPU. A thread takes a tile of queries through everything: positions,
// sums over neighbours, all layers, the head. A tile's intermediates stay in the second-level
// cache, and a layer's weights are read from the third once a tile: with fewer queries a tile the
// products wait for them.
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "lte/base/interruption.h"
#include "lte/ops/cpu/decoder/packed_decoder.h"
#include "lte/tensor/functions.h"
#include "lte/tensor/library.h"

namespace lte::ops {
namespace {

constexpr int64_t kTile = 192;       ///< most queries of a tile; a multiple of the kernels' rows
constexpr int64_t kRowsAtOnce = 12;  ///< of the kernels' products
constexpr int64_t kSubtile = 16;     ///< queries whose activations of γ, 128 KiB, exist at once
constexpr int64_t kPair = 2 * kBlock;

/// What all tiles read.
struct DecoderWork {
  const PackedDecoder& net;
  DecoderSizes sizes;
  const float* attribute;
  PairReader pairs;
  const float* table;
  int64_t table_stride;  ///< from one latent to the next
  const int64_t* index;
  float* sums;  ///< of all queries, [Q, blocks, L, 2, kBlock], or null: they are not kept
  float* out;
  int64_t tile;  ///< most queries of a tile
};

/// One thread's working memory.
class TileDecoder {
 public:
  explicit TileDecoder(const DecoderWork& work)
      : work_(work),
        K_(work.sizes.neighbours),
        L_(work.sizes.layers),
        C_(work.sizes.channels),
        H_(work.sizes.gamma_hidden),
        blocks_(blocks_of(C_)),
        pairs_(blocks_of(K_) * kBlock),
        subtile_(std::min(kSubtile, work.tile)),
        input_(work.tile, work.sizes.attributes),
        features_(work.tile, C_),
        normed_(work.tile, C_),
        attended_(work.tile, C_),
        hidden_(work.tile, kPanel),
        answer_(work.tile, work.sizes.outputs),
        sums_(work.sums != nullptr ? 0 : static_cast<size_t>(work.tile * blocks_ * L_ * kPair)),
        geometry_(static_cast<size_t>(work.sizes.gamma_inputs * pairs_)),
        activation_(work.net.gamma_output.in_bf16() ? 0
                                                    : static_cast<size_t>(subtile_ * H_ * pairs_)),
        rounded_(work.net.gamma_output.in_bf16()
                     ? static_cast<size_t>(subtile_ * pairs_ * hidden_pairs(H_))
                     : 0),
        pair_position_(
            static_cast<size_t>(kProjectedQueries * kProjectedBlocks * pairs_ * kBlock)) {}

  /// Queries [first, first + rows), at most Work::tile.
  void run(int64_t first, int64_t rows) {
    const PackedDecoder& net = work_.net;
    for (int64_t i = 0; i < rows; ++i) {
      const float* from = work_.attribute + (first + i) * work_.sizes.attributes;
      for (int64_t a = 0; a < work_.sizes.attributes; ++a) {
        input_.panel(a / kPanel)[i * kPanel + a % kPanel] = from[a];
      }
    }
    perceptron(net.point_hidden, net.point_output, input_, rows, false, hidden_, features_);
    for (int64_t i = 0; i < rows; i += subtile_) {
      sum_neighbours(first + i, std::min(subtile_, rows - i),
                     sums_of(first) + i * blocks_ * L_ * kPair);
    }
    for (int64_t l = 0; l < L_; ++l) run_layer(net.layers[l], l, sums_of(first), rows);
    net.norm.apply(features_, rows, C_, normed_);
    perceptron(net.head_hidden, net.head_output, normed_, rows, false, hidden_, answer_);
    write(first, rows);
  }

 private:
  /// Fills geometry_ with what γ reads of query q and its neighbours.
  void measure_pairs(int64_t q) {
    const int64_t* near = work_.index + q * K_;
    for (int64_t j = 0; j < K_; ++j) work_.pairs.read(q, near[j], geometry_.data() + j, pairs_);
  }

  void sum_neighbours(int64_t first, int64_t count, float* out) {
    const PackedLinear& gamma = work_.net.gamma_output;
    for (int64_t i = 0; i < count; ++i) {
      measure_pairs(first + i);
      const PairGeometry geometry{geometry_.data(), work_.sizes.gamma_inputs, pairs_};
      if (gamma.in_bf16()) {
        bf16_kernels().hidden_positions(geometry, work_.net.gamma_hidden.data(), H_,
                                        rounded_.data() + i * pairs_ * hidden_pairs(H_));
      } else {
        dense_kernels().hidden_positions(geometry, work_.net.gamma_hidden.data(), H_,
                                         activation_.data() + i * H_ * pairs_);
      }
    }
    const NeighbourTable<float> near{
        work_.table, work_.table_stride, blocks_, L_, work_.index + first * K_, count, K_};
    if (gamma.in_bf16()) {
      bf16_kernels().projected_sums(near,
                                    {rounded_.data(), hidden_pairs(H_), gamma.input_pairs(),
                                     gamma.pairs.data(), gamma.bias.data(), pair_position_.data()},
                                    out);
    } else {
      sum_kernels<float>().projected_sums(near,
                                          {activation_.data(), 0, H_, gamma.weight.data(),
                                           gamma.bias.data(), pair_position_.data()},
                                          out);
    }
  }

  /// Of the tile that begins with query `first`.
  float* sums_of(int64_t first) {
    return work_.sums != nullptr ? work_.sums + first * blocks_ * L_ * kPair : sums_.data();
  }

  void run_layer(const PackedLayer& layer, int64_t l, const float* sums, int64_t rows) {
    layer.norm1.apply(features_, rows, C_, normed_);
    dense(layer.query, normed_, rows, false, attended_);
    for (int64_t p = 0; p < panels_of(C_); ++p) {
      const int64_t first = p * (kPanel / kBlock);
      dense_kernels().attend({attended_.panel(p), rows, std::min(blocks_ - first, kPanel / kBlock),
                              sums + (first * L_ + l) * kPair, blocks_ * L_ * kPair, L_ * kPair,
                              1 / static_cast<float>(K_), attended_.panel(p)});
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

  const DecoderWork& work_;
  int64_t K_, L_, C_, H_;  ///< work's sizes
  int64_t blocks_;         ///< of channels
  int64_t pairs_;          ///< K, rounded up to whole blocks
  int64_t subtile_;        ///< queries whose activations of γ exist at once
  Tile input_, features_, normed_, attended_, hidden_, answer_;
  std::vector<float> sums_;           ///< [tile, blocks, L, 2, kBlock], unless they are kept
  std::vector<float> geometry_;       ///< [F, pairs] of one query
  std::vector<float> activation_;     ///< [subtile, H, pairs]
  std::vector<uint32_t> rounded_;     ///< [subtile, pairs, hidden_pairs(H)], in bfloat16 instead
  std::vector<float> pair_position_;  ///< of as many queries and blocks as exist at once
};

at::Tensor decode(const DecoderInputs& in, const PackedDecoder& net, float* sums) {
  const int64_t Q = in.sizes.queries;
  // Few queries make smaller tiles, so that all threads have some.
  const int64_t share = (Q + at::get_num_threads() - 1) / at::get_num_threads();
  const int64_t tile = std::min(kTile, (share + kRowsAtOnce - 1) / kRowsAtOnce * kRowsAtOnce);
  at::Tensor out = at::empty({Q, in.sizes.outputs}, in.attributes.options());
  const DecoderWork work{net,
                         in.sizes,
                         in.attributes.const_data_ptr<float>(),
                         PairReader(in.near),
                         in.table.const_data_ptr<float>(),
                         in.table.stride(0),
                         in.near.index.const_data_ptr<int64_t>(),
                         sums,
                         out.data_ptr<float>(),
                         tile};
  const int64_t tiles = tile > 0 ? (Q + tile - 1) / tile : 0;
  at::parallel_for(0, tiles, 1, [&](int64_t begin, int64_t end) {
    TileDecoder decoder(work);
    for (int64_t t = begin; t < end; ++t) {
      Interruption::check();
      decoder.run(t * tile, std::min(tile, Q - t * tile));
    }
  });
  return out;
}

at::Tensor query_decoder_inference_cpu(const at::Tensor& attributes, const at::Tensor& position,
                                       const at::Tensor& anchor, const at::Tensor& index,
                                       double scale, double limit,
                                       const std::optional<at::Tensor>& normal,
                                       const std::optional<at::Tensor>& anchor_normal,
                                       const at::Tensor& table, at::TensorList list) {
  const DecoderWeights weights = DecoderWeights::from_list(list, table_layers(table));
  const DecoderInputs in(attributes,
                         {position, anchor, index, scale, limit, normal.value_or(at::Tensor()),
                          anchor_normal.value_or(at::Tensor())},
                         table, weights);
  return decode(in, pack(weights), nullptr);
}

std::tuple<at::Tensor, at::Tensor> query_decoder_cpu(
    const at::Tensor& attributes, const at::Tensor& position, const at::Tensor& anchor,
    const at::Tensor& index, double scale, double limit, const std::optional<at::Tensor>& normal,
    const std::optional<at::Tensor>& anchor_normal, const at::Tensor& table, at::TensorList list) {
  const DecoderWeights weights = DecoderWeights::from_list(list, table_layers(table));
  const DecoderInputs in(attributes,
                         {position, anchor, index, scale, limit, normal.value_or(at::Tensor()),
                          anchor_normal.value_or(at::Tensor())},
                         table, weights);
  at::Tensor sums =
      at::empty({in.sizes.queries, blocks_of(in.sizes.channels), in.sizes.layers, 2, kBlock},
                attributes.options());
  at::Tensor out = decode(in, pack(weights), sums.data_ptr<float>());
  return {out, sums};
}

}  // namespace

std::shared_ptr<const PackedDecoder> pack_decoder(const DecoderWeights& weights) {
  const at::Tensor &point = weights.point.hidden.weight, &gamma = weights.gamma.hidden.weight,
                   &places = weights.gamma.output.weight;
  for (const at::Tensor& t : {point, gamma, places})
    TORCH_CHECK(t.dim() == 2, "query_decoder_inference: dense weights must be matrices, got ",
                t.sizes());
  check_decoder_weights(weights, point.size(1), gamma.size(1), places.size(0), at::kCPU);
  return std::make_shared<const PackedDecoder>(pack(weights));
}

at::Tensor query_decoder_inference(const at::Tensor& attributes, const QueryNeighbourhood& near,
                                   const at::Tensor& table, const PackedDecoder& weights) {
  const DecoderShape& shape = weights.shape;
  const DecoderSizes sizes = check_decoder_queries(attributes, near, table, shape);
  const auto layers = static_cast<int64_t>(weights.layers.size());
  TORCH_CHECK(table.is_cpu() && sizes.attributes == shape.attributes &&
                  sizes.gamma_inputs == shape.gamma_inputs && sizes.layers == layers,
              "query_decoder_inference: packed weights of ", layers, " layers read ",
              shape.attributes, " attributes and ", shape.gamma_inputs,
              " numbers of a pair on the CPU, got ", sizes.layers, ", ", sizes.attributes, " and ",
              sizes.gamma_inputs, " on ", table.device());
  return decode(DecoderInputs(attributes, near, table, sizes), weights, nullptr);
}

}  // namespace lte::ops

TORCH_LIBRARY_IMPL(lte, CPU, m) {
  m.impl("query_decoder_inference", lte::ops::query_decoder_inference_cpu);
  m.impl("query_decoder", lte::ops::query_decoder_cpu);
}
