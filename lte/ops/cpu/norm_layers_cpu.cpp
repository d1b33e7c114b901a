// Norms and what follows them on the CPU, tile by tile.
#include <algorithm>
#include <tuple>
#include <vector>

#include <ATen/Parallel.h>
#include <ATen/ops/empty.h>
#include <ATen/ops/empty_like.h>
#include <torch/library.h>

#include "lte/ops/cpu/tile_layers.h"
#include "lte/ops/norm_layers.h"
#include "lte/ops/norm_layers_args.h"

namespace lte::ops {
namespace {

constexpr int64_t kNormTile = 96;        ///< rows at a time
constexpr int64_t kLeastNormPart = 512;  ///< rows below which a second thread gains nothing

/// Calls use(first, rows) for the tiles of [begin, end).
template <typename Use>
void over_tiles(int64_t begin, int64_t end, const Use& use) {
  for (int64_t first = begin; first < end; first += kNormTile) {
    use(first, std::min(kNormTile, end - first));
  }
}

void clear_rows(Tile& tile, int64_t columns, int64_t rows) {
  for (int64_t p = 0; p < panels_of(columns); ++p) std::fill_n(tile.panel(p), rows * kPanel, 0.0f);
}

/// by_x += the gradient through the norm of `x`, from that by its result.
void add_norm_gradient(const PackedNorm& norm, const Tile& x, const Tile& grad, int64_t rows,
                       int64_t channels, Tile& by_x, NormSums& sums) {
  gradient_kernels().layer_norm_gradient({x.panel(0), rows, x.panel_stride(), channels,
                                          norm.gain.data(), grad.panel(0), by_x.panel(0),
                                          sums.gain.data(), sums.bias.data()});
}

at::Tensor norm_linear_cpu(const at::Tensor& any_x, at::TensorList w) {
  TORCH_CHECK(w.size() == 4, "norm_linear: expected 4 weights, got ", w.size());
  check_norm_args(any_x, w[0], w[1], "norm_linear");
  check_layer_args(any_x, w[2], w[3], "norm_linear");
  const at::Tensor x = any_x.contiguous();
  const int64_t n = x.size(0), C = x.size(1);
  const PackedNorm norm(w[0], w[1]);
  const PackedLinear layer(w[2], w[3]);
  at::Tensor out = at::empty({n, layer.outputs}, x.options());
  at::parallel_for(0, n, kLeastNormPart, [&](int64_t begin, int64_t end) {
    Tile input(kNormTile, C), normed(kNormTile, C), product(kNormTile, layer.outputs);
    over_tiles(begin, end, [&](int64_t first, int64_t rows) {
      load_rows(x.const_data_ptr<float>(), C, first, rows, input);
      norm.apply(input, rows, C, normed);
      dense(layer, normed, rows, false, product);
      store_rows(product, layer.outputs, first, rows, out.data_ptr<float>());
    });
  });
  return out;
}

std::tuple<at::Tensor, std::vector<at::Tensor>> norm_linear_backward_cpu(const at::Tensor& any_grad,
                                                                         const at::Tensor& any_x,
                                                                         at::TensorList w) {
  const at::Tensor grad = any_grad.contiguous(), x = any_x.contiguous();
  const int64_t n = x.size(0), C = x.size(1);
  check_shape(grad, {n, w[2].size(0)}, at::kFloat, "norm_linear_backward", "grad");
  const PackedNorm norm(w[0], w[1]);
  const Layer layer({w[2], w[3]});
  const int64_t outputs = layer.forward.outputs;
  at::Tensor by_x = at::empty_like(x);
  const RowParts parts(n, kLeastNormPart);
  struct Sums {
    NormSums norm;
    LinearGradient layer;
  };
  std::vector<Sums> sums(static_cast<size_t>(parts.parts),
                         {NormSums(norm), LinearGradient(layer.forward)});
  at::parallel_for(0, parts.parts, 1, [&](int64_t begin, int64_t end) {
    Tile input(kNormTile, C), normed(kNormTile, C), from(kNormTile, outputs),
        by_normed(kNormTile, C), to(kNormTile, C);
    for (int64_t part = begin; part < end; ++part) {
      Sums& own = sums[static_cast<size_t>(part)];
      over_tiles(parts.begin(part), parts.begin(part + 1), [&](int64_t first, int64_t rows) {
        load_rows(x.const_data_ptr<float>(), C, first, rows, input);
        load_rows(grad.const_data_ptr<float>(), outputs, first, rows, from);
        norm.apply(input, rows, C, normed);
        own.layer.add(from, normed, rows);
        dense(layer.backward, from, rows, false, by_normed);
        clear_rows(to, C, rows);
        add_norm_gradient(norm, input, by_normed, rows, C, to, own.norm);
        store_rows(to, C, first, rows, by_x.data_ptr<float>());
      });
    }
  });
  const std::vector<at::Tensor> out = zeros_of(w);
  for (const Sums& part : sums) {
    part.norm.write({out[0], out[1]});
    part.layer.write(out[2], out[3]);
  }
  return {by_x, out};
}

void check_feed_forward(const at::Tensor& x, at::TensorList w) {
  const char* op = "feed_forward";
  TORCH_CHECK(w.size() == 6, op, ": expected 6 weights, got ", w.size());
  check_norm_args(x, w[0], w[1], op);
  check_layer_args(x, w[2], w[3], op);
  check_layer_args(w[2].t(), w[4], w[5], op);
  TORCH_CHECK(w[4].size(0) == x.size(1), op, ": the second layer must have ", x.size(1),
              " outputs, got ", w[4].sizes());
}

/// feed_forward() of x + add(x's tile), where add(first, rows, tile) adds to rows [first, first +
/// rows) of x. `least` rows are worth a thread.
template <typename MakeAdd>
at::Tensor feed_tiles(const at::Tensor& any_x, at::TensorList w, int64_t least,
                      const MakeAdd& make_add) {
  const at::Tensor x = any_x.contiguous();
  const int64_t n = x.size(0), C = x.size(1);
  const PackedNorm norm(w[0], w[1]);
  const PackedLinear hidden(w[2], w[3]), output(w[4], w[5]);
  at::Tensor out = at::empty_like(x);
  at::parallel_for(0, n, least, [&](int64_t begin, int64_t end) {
    Tile input(kNormTile, C), normed(kNormTile, C), activation(kNormTile, kPanel);
    auto add = make_add();
    over_tiles(begin, end, [&](int64_t first, int64_t rows) {
      load_rows(x.const_data_ptr<float>(), C, first, rows, input);
      add(first, rows, input);
      norm.apply(input, rows, C, normed);
      perceptron(hidden, output, normed, rows, true, activation, input);
      store_rows(input, C, first, rows, out.data_ptr<float>());
    });
  });
  return out;
}

at::Tensor feed_forward_cpu(const at::Tensor& x, at::TensorList w) {
  check_feed_forward(x, w);
  return feed_tiles(x, w, kLeastNormPart, [] { return [](int64_t, int64_t, Tile&) {}; });
}

at::Tensor project_feed_forward_cpu(const at::Tensor& x, const at::Tensor& any_attended,
                                    at::TensorList w) {
  const char* op = "project_feed_forward";
  TORCH_CHECK(w.size() == 8, op, ": expected 8 weights, got ", w.size());
  check_feed_forward(x, w.slice(0, 6));
  check_shape(any_attended, {x.size(0), w[6].size(1)}, at::kFloat, op, "attended");
  check_layer_args(any_attended, w[6], w[7], op);
  TORCH_CHECK(w[6].size(0) == x.size(1), op, ": the projection must have ", x.size(1),
              " outputs, got ", w[6].sizes());
  const at::Tensor attended = any_attended.contiguous();
  const auto* from = attended.const_data_ptr<float>();
  const PackedLinear projection(w[6], w[7]);
  return feed_tiles(x, w.slice(0, 6), kLeastNormPart / 4, [&] {
    return [&, tile = Tile(kNormTile, projection.inputs)](int64_t first, int64_t rows,
                                                          Tile& input) mutable {
      load_rows(from, projection.inputs, first, rows, tile);
      dense(projection, tile, rows, true, input);
    };
  });
}

std::tuple<at::Tensor, std::vector<at::Tensor>> feed_forward_backward_cpu(
    const at::Tensor& any_grad, const at::Tensor& any_x, at::TensorList w) {
  check_feed_forward(any_x, w);
  const at::Tensor grad = any_grad.contiguous(), x = any_x.contiguous();
  const int64_t n = x.size(0), C = x.size(1);
  check_shape(grad, x.sizes(), at::kFloat, "feed_forward_backward", "grad");
  const PackedNorm norm(w[0], w[1]);
  const Perceptron net({{w[2], w[3]}, {w[4], w[5]}});
  const int64_t width = net.hidden.forward.outputs;
  at::Tensor by_x = at::empty_like(x);
  const RowParts parts(n, kLeastNormPart);
  struct Sums {
    NormSums norm;
    PerceptronSums net;
  };
  std::vector<Sums> sums(static_cast<size_t>(parts.parts), {NormSums(norm), PerceptronSums(net)});
  at::parallel_for(0, parts.parts, 1, [&](int64_t begin, int64_t end) {
    Tile input(kNormTile, C), normed(kNormTile, C), from(kNormTile, C), by_hidden(kNormTile, width),
        by_normed(kNormTile, C);
    Hidden hidden(kNormTile, width);
    for (int64_t part = begin; part < end; ++part) {
      Sums& own = sums[static_cast<size_t>(part)];
      over_tiles(parts.begin(part), parts.begin(part + 1), [&](int64_t first, int64_t rows) {
        load_rows(x.const_data_ptr<float>(), C, first, rows, input);
        load_rows(grad.const_data_ptr<float>(), C, first, rows, from);
        norm.apply(input, rows, C, normed);
        activate(net.hidden, normed, rows, hidden);
        return_through(net, from, normed, hidden, rows, false, own.net, by_hidden, &by_normed);
        add_norm_gradient(norm, input, by_normed, rows, C, from, own.norm);
        store_rows(from, C, first, rows, by_x.data_ptr<float>());
      });
    }
  });
  const std::vector<at::Tensor> out = zeros_of(w);
  for (const Sums& part : sums) {
    part.norm.write({out[0], out[1]});
    part.net.write({{out[2], out[3]}, {out[4], out[5]}});
  }
  return {by_x, out};
}

}  // namespace
}  // namespace lte::ops

TORCH_LIBRARY_IMPL(lte, CPU, m) {
  m.impl("norm_linear", lte::ops::norm_linear_cpu);
  m.impl("norm_linear_backward", lte::ops::norm_linear_backward_cpu);
  m.impl("feed_forward", lte::ops::feed_forward_cpu);
  m.impl("project_feed_forward", lte::ops::project_feed_forward_cpu);
  m.impl("feed_forward_backward", lte::ops::feed_forward_backward_cpu);
}
