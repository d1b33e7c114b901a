// A dense layer and the centered norm of what it gives, on the CPU. The means are over all rows of
// a scene, so tiles of rows are passed through twice, forwards and backwards. Sums over rows are
// made tile by tile and then in the order of the tiles, whatever the number of threads.
#include <algorithm>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "lte/ops/cpu/dense/tile_layers.h"
#include "lte/ops/norm_layers_args.h"
#include "lte/tensor/functions.h"
#include "lte/tensor/library.h"

namespace lte::ops {
namespace {

/// Rows of one scene.
struct RowTile {
  int64_t first, rows;
  size_t scene;
};

class RowTiles {
 public:
  explicit RowTiles(at::IntArrayRef counts) : counts_(counts) {
    int64_t begin = 0;
    for (size_t scene = 0; scene < counts.size(); ++scene) {
      for (int64_t at = 0; at < counts[scene]; at += kNormTile)
        tiles_.push_back({begin + at, std::min(kNormTile, counts[scene] - at), scene});
      begin += counts[scene];
    }
  }

  size_t size() const { return tiles_.size(); }
  const RowTile& operator[](size_t i) const { return tiles_[i]; }
  size_t scenes() const { return counts_.size(); }
  int64_t rows_of(size_t scene) const { return counts_[scene]; }

 private:
  at::IntArrayRef counts_;
  std::vector<RowTile> tiles_;
};

/// Sums of columns by tile, and then by scene.
class ColumnSums {
 public:
  ColumnSums(const RowTiles& tiles, int64_t columns)
      : tiles_(tiles),
        width_(blocks_of(columns) * kBlock),
        sums_(tiles.size() * static_cast<size_t>(width_)) {}

  void add(size_t tile, const Tile& values) {
    float* to = sums_.data() + tile * static_cast<size_t>(width_);
    for (int64_t c = 0; c < width_; c += kPanel) {
      gradient_kernels().sum_columns(values.panel(c / kPanel), tiles_[tile].rows,
                                     std::min(kPanel, width_ - c) / kBlock, to + c);
    }
  }

  /// [scenes][columns, to whole blocks]
  std::vector<std::vector<double>> of_scenes() const {
    std::vector<std::vector<double>> out(tiles_.scenes(),
                                         std::vector<double>(static_cast<size_t>(width_)));
    for (size_t tile = 0; tile < tiles_.size(); ++tile) {
      std::vector<double>& to = out[tiles_[tile].scene];
      for (size_t c = 0; c < to.size(); ++c) to[c] += sums_[tile * to.size() + c];
    }
    return out;
  }

 private:
  const RowTiles& tiles_;
  int64_t width_;
  std::vector<float> sums_;
};

/// What is added to the rows of each scene before the norm: less the share of their means.
std::vector<std::vector<float>> offsets_of(const std::vector<std::vector<double>>& sums,
                                           const RowTiles& tiles, const float* share, int64_t C) {
  std::vector<std::vector<float>> offsets;
  for (size_t scene = 0; scene < sums.size(); ++scene) {
    std::vector<float>& to = offsets.emplace_back(sums[scene].size());
    const auto rows = static_cast<double>(tiles.rows_of(scene));
    for (int64_t c = 0; c < C && rows > 0; ++c)
      to[static_cast<size_t>(c)] =
          static_cast<float>(-share[c] * sums[scene][static_cast<size_t>(c)] / rows);
  }
  return offsets;
}

void check_linear_norm(const at::Tensor& x, at::TensorList w, at::IntArrayRef counts) {
  const char* op = "linear_norm";
  TORCH_CHECK(w.size() == 4 || w.size() == 5, op, ": expected 4 or 5 weights, got ", w.size());
  TORCH_CHECK(x.dim() == 2 && x.scalar_type() == at::kFloat && x.is_cpu(), op,
              ": x must be [n, C] float32 on the CPU, got ", x.sizes(), " ", x.scalar_type(),
              " on ", x.device());
  check_layer_args(x, w[0], w[1], op);
  for (const at::Tensor& t : w.slice(2)) check_shape(t, {w[0].size(0)}, at::kFloat, op, "a norm");
  int64_t rows = 0;
  for (const int64_t count : counts) {
    TORCH_CHECK(count >= 0, op, ": a scene of ", count, " rows");
    rows += count;
  }
  TORCH_CHECK(rows == x.size(0), op, ": scenes of ", rows, " rows in all for ", x.size(0));
}

/// Threads take runs of tiles.
template <typename Use>
void over_row_tiles(const RowTiles& tiles, const Use& use) {
  at::parallel_for(0, static_cast<int64_t>(tiles.size()), 4, [&](int64_t begin, int64_t end) {
    use(static_cast<size_t>(begin), static_cast<size_t>(end));
  });
}

std::tuple<at::Tensor, at::Tensor> linear_norm_cpu(const at::Tensor& any_x,
                                                   const std::optional<at::Tensor>& any_residual,
                                                   at::TensorList w, at::IntArrayRef counts) {
  check_linear_norm(any_x, w, counts);
  const at::Tensor x = any_x.contiguous();
  const int64_t n = x.size(0), C = x.size(1), O = w[0].size(0);
  at::Tensor residual;
  if (any_residual.has_value() && any_residual->defined()) {
    residual = any_residual->contiguous();
    check_shape(residual, {n, O}, at::kFloat, "linear_norm", "residual");
  }
  const PackedLinear layer(w[0], w[1]);
  const PackedNorm norm(w[2], w[3]);
  const RowTiles tiles(counts);
  at::Tensor product = at::empty({n, O}, x.options()), out = at::empty_like(product);
  ColumnSums sums(tiles, O);
  over_row_tiles(tiles, [&](size_t begin, size_t end) {
    Tile from(kNormTile, C), to(kNormTile, O);
    for (size_t i = begin; i < end; ++i) {
      load_rows(x.const_data_ptr<float>(), C, tiles[i].first, tiles[i].rows, from);
      dense(layer, from, tiles[i].rows, false, to);
      store_rows(to, O, tiles[i].first, tiles[i].rows, product.data_ptr<float>());
      sums.add(i, to);
    }
  });
  std::vector<std::vector<float>> offsets;
  if (w.size() == 5) {
    const at::Tensor share = w[4].contiguous();
    offsets = offsets_of(sums.of_scenes(), tiles, share.const_data_ptr<float>(), O);
  }
  over_row_tiles(tiles, [&](size_t begin, size_t end) {
    Tile values(kNormTile, O), normed(kNormTile, O);
    for (size_t i = begin; i < end; ++i) {
      const auto [first, rows, scene] = tiles[i];
      load_rows(product.const_data_ptr<float>(), O, first, rows, values);
      if (!offsets.empty()) add_to_rows(offsets[scene], rows, values);
      norm.apply(values, rows, O, normed);
      store_rows(normed, O, first, rows, out.data_ptr<float>());
      if (residual.defined()) {
        dense_kernels().accumulate(residual.const_data_ptr<float>() + first * O, rows * O,
                                   out.data_ptr<float>() + first * O);
      }
    }
  });
  return {out, product};
}

/// The way back: to what the norm was taken of, whose sums are the gradients by the means, and from
/// there through the layer.
class LinearNormGradient {
 public:
  /// Checked and contiguous. @param product  what linear_norm_cpu() gave second
  LinearNormGradient(const at::Tensor& grad, const at::Tensor& x, const at::Tensor& product,
                     at::TensorList w, at::IntArrayRef counts)
      : grad_(grad),
        x_(x),
        product_(product),
        share_(w.size() == 5 ? w[4].contiguous() : at::Tensor()),
        layer_({w[0], w[1]}),
        norm_(w[2], w[3]),
        tiles_(counts),
        parts_(static_cast<int64_t>(tiles_.size()), kMinNormPart / kNormTile),
        by_centered_(at::empty_like(product)),
        by_weights_(room_for(w)) {
    std::vector<std::vector<double>> sums;
    if (centers()) {
      sums = sums_of_product();
      offsets_ = offsets_from(sums);
    }
    const std::vector<std::vector<double>> by_means = return_through_norm();
    if (!centers()) return;
    add_by_share(sums, by_means);
    offsets_ = offsets_from(by_means);  // a mean's gradient goes to all rows alike
  }

  /// The gradient by x.
  at::Tensor return_through_layer() {
    at::Tensor by_x = at::empty_like(x_);
    std::vector<LinearGradient> sums(static_cast<size_t>(parts_.parts),
                                     LinearGradient(layer_.forward));
    const int64_t C = x_.size(1), O = product_.size(1);
    over_parts([&](size_t part, size_t begin, size_t end) {
      Tile from(kNormTile, O), input(kNormTile, C), to(kNormTile, C);
      for (size_t i = begin; i < end; ++i) {
        const auto [first, rows, scene] = tiles_[i];
        load(by_centered_, tiles_[i], from);
        load(x_, tiles_[i], input);
        if (centers()) add_to_rows(offsets_[scene], rows, from);
        sums[part].add(from, input, rows);
        dense(layer_.backward, from, rows, false, to);
        store_rows(to, C, first, rows, by_x.data_ptr<float>());
      }
    });
    for (const LinearGradient& part : sums)
      part.write(by_weights_[0], by_weights_[1], &part != &sums.front());
    return by_x;
  }

  const std::vector<at::Tensor>& by_weights() const { return by_weights_; }

 private:
  bool centers() const { return share_.defined(); }

  static void load(const at::Tensor& rows, const RowTile& tile, Tile& to) {
    load_rows(rows.const_data_ptr<float>(), rows.size(1), tile.first, tile.rows, to);
  }

  template <typename Use>
  void over_parts(const Use& use) const {
    at::parallel_for(0, parts_.parts, 1, [&](int64_t begin, int64_t end) {
      for (int64_t part = begin; part < end; ++part) {
        use(static_cast<size_t>(part), static_cast<size_t>(parts_.begin(part)),
            static_cast<size_t>(parts_.begin(part + 1)));
      }
    });
  }

  std::vector<std::vector<float>> offsets_from(const std::vector<std::vector<double>>& sums) const {
    return offsets_of(sums, tiles_, share_.const_data_ptr<float>(), product_.size(1));
  }

  std::vector<std::vector<double>> sums_of_product() const {
    ColumnSums sums(tiles_, product_.size(1));
    over_row_tiles(tiles_, [&](size_t begin, size_t end) {
      Tile values(kNormTile, product_.size(1));
      for (size_t i = begin; i < end; ++i) {
        load(product_, tiles_[i], values);
        sums.add(i, values);
      }
    });
    return sums.of_scenes();
  }

  /// Fills by_centered_; what comes back is its sums, if means are subtracted.
  std::vector<std::vector<double>> return_through_norm() {
    const int64_t O = product_.size(1);
    ColumnSums sums(tiles_, O);
    std::vector<NormSums> of_norm(static_cast<size_t>(parts_.parts), NormSums(norm_));
    over_parts([&](size_t part, size_t begin, size_t end) {
      Tile values(kNormTile, O), from(kNormTile, O), to(kNormTile, O);
      for (size_t i = begin; i < end; ++i) {
        const auto [first, rows, scene] = tiles_[i];
        load(product_, tiles_[i], values);
        load(grad_, tiles_[i], from);
        if (centers()) add_to_rows(offsets_[scene], rows, values);
        clear_rows(to, O, rows);
        add_norm_gradient(norm_, values, from, rows, O, to, of_norm[part]);
        store_rows(to, O, first, rows, by_centered_.data_ptr<float>());
        if (centers()) sums.add(i, to);
      }
    });
    for (const NormSums& part : of_norm)
      part.write({by_weights_[2], by_weights_[3]}, &part != &of_norm.front());
    return sums.of_scenes();
  }

  /// @param sums  of columns of `product`, @param by_means  of the gradient
  void add_by_share(const std::vector<std::vector<double>>& sums,
                    const std::vector<std::vector<double>>& by_means) const {
    auto* by_share = by_weights_[4].data_ptr<float>();
    for (size_t c = 0; c < static_cast<size_t>(product_.size(1)); ++c) {
      double sum = 0;
      for (size_t scene = 0; scene < sums.size(); ++scene) {
        const auto rows = static_cast<double>(tiles_.rows_of(scene));
        if (rows > 0) sum -= sums[scene][c] / rows * by_means[scene][c];
      }
      by_share[c] = static_cast<float>(sum);
    }
  }

  at::Tensor grad_, x_, product_, share_;
  Layer layer_;
  PackedNorm norm_;
  RowTiles tiles_;
  RowParts parts_;
  std::vector<std::vector<float>> offsets_;  ///< what the rows of each scene are moved by
  at::Tensor by_centered_;                   ///< the gradient by what the norm was taken of
  std::vector<at::Tensor> by_weights_;
};

/// @param product  what linear_norm_cpu() gave second
std::tuple<at::Tensor, std::vector<at::Tensor>> linear_norm_backward_cpu(const at::Tensor& grad,
                                                                         const at::Tensor& x,
                                                                         const at::Tensor& product,
                                                                         at::TensorList w,
                                                                         at::IntArrayRef counts) {
  const char* op = "linear_norm_backward";
  check_linear_norm(x, w, counts);
  for (const auto& [name, t] : {std::pair{"grad", grad}, {"product", product}})
    check_shape(t, {x.size(0), w[0].size(0)}, at::kFloat, op, name);
  LinearNormGradient gradient(grad.contiguous(), x.contiguous(), product.contiguous(), w, counts);
  const at::Tensor by_x = gradient.return_through_layer();
  return {by_x, gradient.by_weights()};
}

}  // namespace
}  // namespace lte::ops

TORCH_LIBRARY_IMPL(lte, CPU, m) {
  m.impl("linear_norm", lte::ops::linear_norm_cpu);
  m.impl("linear_norm_backward", lte::ops::linear_norm_backward_cpu);
}
