// The query decoder backwards on the CPU. A thread takes a tile of queries through all layers
// again, keeps what each of them needs in the second-level cache, and walks back. Pairs of a query
// and a neighbour come last: their positions are made again, 128 at a time, and kept until the tile
// has given its part of the gradient by the table. Sums over queries are made in a few runs of
// fixed length, so that they are the same for any number of threads.
#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "lte/ops/cpu/decoder/decoder_sums.h"
#include "lte/ops/cpu/decoder/packed_decoder.h"
#include "lte/ops/cpu/decoder/table_gradient.h"
#include "lte/ops/cpu/dense/tile_layers.h"
#include "lte/tensor/functions.h"
#include "lte/tensor/library.h"

namespace lte::ops {
namespace {

constexpr int64_t kGradientTile = 48;  ///< queries of a tile; a multiple of the kernels' rows
constexpr int64_t kMinPart = 512;      ///< queries below which a second thread gains nothing
constexpr int64_t kGradientPair = 2 * kBlock;

/// What all tiles read.
struct GradientWork {
  const DecoderNetwork& net;
  DecoderSizes sizes;
  const float *grad, *attribute;
  PairReader pairs;
  const float* table;
  int64_t table_stride;  ///< from one latent to the next
  const int64_t* index;
  const float* sums;

  /// Floats of a latent in the table, and of a query in the sums.
  int64_t entry() const { return blocks_of(sizes.channels) * sizes.layers * kGradientPair; }
};

/// What a run of queries sums up.
struct RunSums {
  DecoderSums weights;
  TableGradient table;
};

/// One thread's working memory.
class TileReturn {
 public:
  TileReturn(const GradientWork& work, RunSums& sums)
      : work_(work),
        sums_(sums.weights),
        by_table_(sums.table),
        K_(work.sizes.neighbours),
        L_(work.sizes.layers),
        C_(work.sizes.channels),
        H_(work.sizes.gamma_hidden),
        blocks_(blocks_of(C_)),
        input_(kGradientTile, work.sizes.attributes),
        point_(kGradientTile, work.net.point.hidden.forward.outputs),
        head_(kGradientTile, work.net.head.hidden.forward.outputs),
        normed_(kGradientTile, C_),
        answer_(kGradientTile, work.sizes.outputs),
        grad_(kGradientTile, C_),
        by_branch_(kGradientTile, C_),
        by_hidden_(kGradientTile, widest_hidden()),
        geometry_(kPanel, work.net.gamma.hidden.forward.inputs),
        gamma_(kPanel, H_),
        pair_(kPanel, C_),
        by_activation_(kPanel, H_),
        by_sums_(static_cast<size_t>(kGradientTile * work.entry())),
        positions_(static_cast<size_t>(kGradientTile * K_ * blocks_ * kBlock)),
        by_position_(static_cast<size_t>(std::max(kPanel, K_) * blocks_ * kBlock)) {
    for (const DecoderBlock& block : work.net.blocks) {
      kept_.emplace_back(C_, block.ffn.hidden.forward.outputs);
    }
    last_ = Tile(kGradientTile, C_);
  }

  /// Queries [first, first + rows), at most kGradientTile.
  void run(int64_t first, int64_t rows) {
    forward(first, rows);
    return_to_layers(first, rows);
    for (int64_t l = L_; l-- > 0;) return_through_layer(l, first, rows);
    return_through(work_.net.point, grad_, input_, point_, rows, false, sums_.point, by_hidden_,
                   nullptr);
    return_to_pairs(first, rows);
    by_table_.add(neighbours(first, rows), by_sums_.data(), positions_.data());
  }

 private:
  /// What a layer's way back reads of its way forth.
  struct Kept {
    Tile input, normed1, query, attended, middle, normed2;
    Hidden hidden;

    Kept(int64_t C, int64_t width)
        : input(kGradientTile, C),
          normed1(kGradientTile, C),
          query(kGradientTile, C),
          attended(kGradientTile, C),
          middle(kGradientTile, C),
          normed2(kGradientTile, C),
          hidden(kGradientTile, width) {}
  };

  int64_t widest_hidden() const {
    int64_t widest =
        std::max(work_.net.point.hidden.forward.outputs, work_.net.head.hidden.forward.outputs);
    for (const DecoderBlock& block : work_.net.blocks) {
      widest = std::max(widest, block.ffn.hidden.forward.outputs);
    }
    return widest;
  }

  int64_t width() const { return blocks_ * kBlock; }  ///< of a row of channels

  NeighbourTable<float> neighbours(int64_t first, int64_t rows) const {
    return {work_.table, work_.table_stride, blocks_, L_, work_.index + first * K_, rows, K_};
  }

  Tile& features_after(int64_t l) { return l + 1 < L_ ? kept_[l + 1].input : last_; }

  void copy_rows(const Tile& from, int64_t rows, Tile& to) const {
    for (int64_t c = 0; c < width(); c += kPanel) {
      for (int64_t r = 0; r < rows; ++r) {
        copy_row(from.panel(c / kPanel) + r * kPanel, std::min(kPanel, width() - c),
                 to.panel(c / kPanel) + r * kPanel);
      }
    }
  }

  void forward(int64_t first, int64_t rows) {
    const DecoderNetwork& net = work_.net;
    const int64_t A = work_.sizes.attributes;
    for (int64_t i = 0; i < rows; ++i) {
      for (int64_t a = 0; a < A; ++a) {
        input_.panel(a / kPanel)[i * kPanel + a % kPanel] = work_.attribute[(first + i) * A + a];
      }
    }
    activate(net.point, input_, rows, point_);
    dense(net.point.output.forward, point_.value, rows, false, L_ > 0 ? kept_[0].input : last_);
    for (int64_t l = 0; l < L_; ++l) {
      const DecoderBlock& block = net.blocks[l];
      Kept& kept = kept_[l];
      block.norm1.apply(kept.input, rows, C_, kept.normed1);
      dense(block.query.forward, kept.normed1, rows, false, kept.query);
      for (int64_t p = 0; p < panels_of(C_); ++p) {
        const int64_t from = p * kPanelBlocks;
        dense_kernels().attend(
            {kept.query.panel(p), rows, std::min(blocks_ - from, kPanelBlocks),
             work_.sums + first * work_.entry() + (from * L_ + l) * kGradientPair, work_.entry(),
             L_ * kGradientPair, 1 / static_cast<float>(K_), kept.attended.panel(p)});
      }
      copy_rows(kept.input, rows, kept.middle);
      dense(block.output.forward, kept.attended, rows, true, kept.middle);
      block.norm2.apply(kept.middle, rows, C_, kept.normed2);
      activate(block.ffn, kept.normed2, rows, kept.hidden);
      copy_rows(kept.middle, rows, features_after(l));
      dense(block.ffn.output.forward, kept.hidden.value, rows, true, features_after(l));
    }
    net.norm.apply(last_, rows, C_, normed_);
    activate(net.head, normed_, rows, head_);
    dense(net.head.output.forward, head_.value, rows, false, answer_);
  }

  /// Fills grad_ with the gradient by the last layer's features.
  void return_to_layers(int64_t first, int64_t rows) {
    const int64_t outputs = work_.sizes.outputs;
    for (int64_t i = 0; i < rows; ++i) {
      for (int64_t o = 0; o < outputs; ++o) {
        float& x = answer_.panel(o / kPanel)[i * kPanel + o % kPanel];
        // Softplus is the identity above 20, as LibTorch has it.
        const float slope = x > 20 ? 1.0f : 1 / (1 + std::exp(-x));
        x = work_.grad[(first + i) * outputs + o] * slope;
      }
    }
    return_through(work_.net.head, answer_, normed_, head_, rows, false, sums_.head, by_hidden_,
                   &by_branch_);
    clear_rows(grad_, C_, rows);
    return_through_norm(work_.net.norm, last_, rows, sums_.norm);
  }

  /// grad_ += that through a norm of `x`, from by_branch_.
  void return_through_norm(const PackedNorm& norm, const Tile& x, int64_t rows, NormSums& sums) {
    add_norm_gradient(norm, x, by_branch_, rows, C_, grad_, sums);
  }

  /// From the gradient by what layer l gives, in grad_, to that by what it was given.
  void return_through_layer(int64_t l, int64_t first, int64_t rows) {
    const DecoderBlock& block = work_.net.blocks[l];
    DecoderSums::OfBlock& sums = sums_.blocks[l];
    const Kept& kept = kept_[l];
    return_through(block.ffn, grad_, kept.normed2, kept.hidden, rows, false, sums.ffn, by_hidden_,
                   &by_branch_);
    return_through_norm(block.norm2, kept.middle, rows, sums.norm2);
    sums.output.add(grad_, kept.attended, rows);
    dense(block.output.backward, grad_, rows, false, by_branch_);
    for (int64_t p = 0; p < panels_of(C_); ++p) {
      const int64_t from = p * kPanelBlocks, at = (from * L_ + l) * kGradientPair;
      gradient_kernels().attend_gradient(
          {kept.query.panel(p), rows, std::min(blocks_ - from, kPanelBlocks),
           work_.sums + first * work_.entry() + at, work_.entry(), L_ * kGradientPair,
           1 / static_cast<float>(K_), by_branch_.panel(p), by_sums_.data() + at});
    }
    sums.query.add(by_branch_, kept.normed1, rows);
    dense(block.query.backward, by_branch_, rows, false, spare_);  // not where it reads
    std::swap(by_branch_, spare_);
    return_through_norm(block.norm1, kept.input, rows, sums.norm1);
  }

  /// Gradients by γ, and the positions of the pairs, for as many queries at a time as have a panel
  /// of pairs.
  void return_to_pairs(int64_t first, int64_t rows) {
    const int64_t group = std::max<int64_t>(1, kPanel / K_);
    for (int64_t q = 0; q < rows; q += group) {
      return_to_group(first, q, std::min(group, rows - q));
    }
  }

  /// Queries [q, q + rows) of the tile that begins with query `tile`.
  void return_to_group(int64_t tile, int64_t q, int64_t rows) {
    const int64_t pairs = rows * K_, first = tile + q;
    float* positions = positions_.data() + q * K_ * width();
    for (int64_t i = 0; i < pairs; i += kPanel) {
      const int64_t count = std::min(kPanel, pairs - i);
      place(first * K_ + i, count);
      dense(work_.net.gamma.output.forward, gamma_.value, count, false, pair_);
      store_rows(pair_, width(), 0, count, positions + i * width());
    }
    sum_kernels<float>().position_gradient(neighbours(first, rows),
                                           by_sums_.data() + q * work_.entry(), positions,
                                           by_position_.data());
    for (int64_t i = 0; i < pairs; i += kPanel) {
      const int64_t count = std::min(kPanel, pairs - i);
      if (pairs > kPanel) place(first * K_ + i, count);  // else it is there still
      load_rows(by_position_.data() + i * width(), width(), 0, count, pair_);
      return_through(work_.net.gamma, pair_, geometry_, gamma_, count, false, sums_.gamma,
                     by_activation_, nullptr);
    }
  }

  /// Geometry and hidden layer of γ of `count` pairs.
  void place(int64_t pair, int64_t count) {
    int64_t q = pair / K_, next = (q + 1) * K_;
    for (int64_t i = 0; i < count; ++i) {
      if (pair + i == next) {
        ++q;
        next += K_;
      }
      work_.pairs.read(q, work_.index[pair + i], geometry_.panel(0) + i * kPanel, 1);
    }
    activate(work_.net.gamma, geometry_, count, gamma_);
  }

  static constexpr int64_t kPanelBlocks = kPanel / kBlock;
  const GradientWork& work_;
  DecoderSums& sums_;
  TableGradient& by_table_;
  int64_t K_, L_, C_, H_;  ///< work's sizes
  int64_t blocks_;         ///< of channels
  Tile input_;
  Hidden point_, head_;
  Tile normed_, answer_, grad_, by_branch_, by_hidden_;
  Tile last_{0, 0};
  Tile spare_{kGradientTile, C_};
  std::vector<Kept> kept_;
  Tile geometry_;  ///< a row a pair
  Hidden gamma_;
  Tile pair_, by_activation_;
  std::vector<float> by_sums_;      ///< by the sums of the tile's queries, [kGradientTile, entry]
  std::vector<float> positions_;    ///< of its pairs, [kGradientTile * K, blocks * kBlock]
  std::vector<float> by_position_;  ///< [kPanel or K, blocks * kBlock]
};

/// The gradient by the table, laid out as that: what runs of queries have summed up.
at::Tensor by_table(const DecoderInputs& in, int64_t entry, const std::vector<RunSums>& runs) {
  at::Tensor out = at::empty(in.table.sizes(), in.table.options());
  auto* to = out.data_ptr<float>();
  at::parallel_for(0, in.sizes.latents, 64, [&](int64_t begin, int64_t end) {
    std::fill_n(to + begin * entry, (end - begin) * entry, 0.0f);
    for (const RunSums& run : runs) {
      for (int64_t j = begin; j < end; ++j) {
        if (run.table.is_read(j))
          dense_kernels().accumulate(run.table.of(j), entry, to + j * entry);
      }
    }
  });
  return out;
}

std::tuple<at::Tensor, std::vector<at::Tensor>> query_decoder_backward_cpu(
    const at::Tensor& any_grad, const at::Tensor& attributes, const at::Tensor& position,
    const at::Tensor& anchor, const at::Tensor& index, double scale, double limit,
    const std::optional<at::Tensor>& normal, const std::optional<at::Tensor>& anchor_normal,
    const at::Tensor& table, const at::Tensor& sums, at::TensorList list) {
  const DecoderWeights weights = DecoderWeights::from_list(list, table_layers(table));
  const DecoderInputs in(attributes,
                         {position, anchor, index, scale, limit, normal.value_or(at::Tensor()),
                          anchor_normal.value_or(at::Tensor())},
                         table, weights);
  check_query_decoder_backward_args(any_grad, sums, in.sizes);
  const at::Tensor grad = any_grad.contiguous();
  const std::vector<at::Tensor> by_weights = room_for(list);
  const DecoderNetwork net(weights);
  const GradientWork work{net,
                          in.sizes,
                          grad.const_data_ptr<float>(),
                          in.attributes.const_data_ptr<float>(),
                          PairReader(in.near),
                          in.table.const_data_ptr<float>(),
                          in.table.stride(0),
                          in.near.index.const_data_ptr<int64_t>(),
                          sums.const_data_ptr<float>()};
  const RowParts parts(in.sizes.queries, kMinPart);
  std::vector<RunSums> runs;
  for (int64_t part = 0; part < parts.parts; ++part) {
    runs.push_back({DecoderSums(net), TableGradient(in.sizes.latents, work.entry())});
  }
  at::parallel_for(0, parts.parts, 1, [&](int64_t begin, int64_t end) {
    for (int64_t part = begin; part < end; ++part) {
      TileReturn tile(work, runs[static_cast<size_t>(part)]);
      for (int64_t q = parts.begin(part); q < parts.begin(part + 1); q += kGradientTile) {
        tile.run(q, std::min(kGradientTile, parts.begin(part + 1) - q));
      }
    }
  });
  const DecoderWeights to = DecoderWeights::from_list(by_weights, in.sizes.layers);
  for (const RunSums& run : runs) run.weights.write(to, &run != &runs.front());
  return {by_table(in, work.entry(), runs), by_weights};
}

}  // namespace
}  // namespace lte::ops

TORCH_LIBRARY_IMPL(lte, CPU, m) {
  m.impl("query_decoder_backward", lte::ops::query_decoder_backward_cpu);
}
