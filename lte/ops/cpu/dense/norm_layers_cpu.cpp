// Norms and what follows them on the CPU, tile by tile.
#include <algorithm>
#include <tuple>
#include <vector>

#include "lte/ops/cpu/dense/tile_layers.h"
#include "lte/ops/norm_layers.h"
#include "lte/ops/norm_layers_args.h"
#include "lte/tensor/functions.h"
#include "lte/tensor/library.h"

namespace lte::ops {
namespace {

/// Calls use(first, rows) for the tiles of [begin, end).
template <typename Use>
void over_tiles(int64_t begin, int64_t end, const Use& use) {
  for (int64_t first = begin; first < end; first += kNormTile) {
    use(first, std::min(kNormTile, end - first));
  }
}

at::Tensor layer_norm_cpu(const at::Tensor& any_x, const at::Tensor& gain, const at::Tensor& bias) {
  check_norm_args(any_x, gain, bias, "layer_norm");
  const at::Tensor x = any_x.contiguous();
  const int64_t n = x.size(0), C = x.size(1);
  const PackedNorm norm(gain, bias);
  at::Tensor out = at::empty_like(x);
  at::parallel_for(0, n, kMinNormPart, [&](int64_t begin, int64_t end) {
    Tile input(kNormTile, C), normed(kNormTile, C);
    over_tiles(begin, end, [&](int64_t first, int64_t rows) {
      load_rows(x.const_data_ptr<float>(), C, first, rows, input);
      norm.apply(input, rows, C, normed);
      store_rows(normed, C, first, rows, out.data_ptr<float>());
    });
  });
  return out;
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
  at::parallel_for(0, n, kMinNormPart, [&](int64_t begin, int64_t end) {
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
  const RowParts parts(n, kMinNormPart);
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
  const std::vector<at::Tensor> out = room_for(w);
  for (const Sums& part : sums) {
    const bool add = &part != &sums.front();
    part.norm.write({out[0], out[1]}, add);
    part.layer.write(out[2], out[3], add);
  }
  return {by_x, out};
}

void check_project_feed_forward(const at::Tensor& x, const at::Tensor& attended, at::TensorList w) {
  const char* op = "project_feed_forward";
  TORCH_CHECK(w.size() == 8, op, ": expected 8 weights, got ", w.size());
  check_norm_args(x, w[0], w[1], op);
  check_layer_args(x, w[2], w[3], op);
  check_layer_args(w[2].t(), w[4], w[5], op);
  TORCH_CHECK(w[4].size(0) == x.size(1), op, ": the second layer must have ", x.size(1),
              " outputs, got ", w[4].sizes());
  check_shape(attended, {x.size(0), w[6].size(1)}, at::kFloat, op, "attended");
  check_layer_args(attended, w[6], w[7], op);
  TORCH_CHECK(w[6].size(0) == x.size(1), op, ": the projection must have ", x.size(1),
              " outputs, got ", w[6].sizes());
}

at::Tensor project_feed_forward_cpu(const at::Tensor& any_x, const at::Tensor& any_attended,
                                    at::TensorList w) {
  check_project_feed_forward(any_x, any_attended, w);
  const at::Tensor x = any_x.contiguous(), attended = any_attended.contiguous();
  const int64_t n = x.size(0), C = x.size(1), A = attended.size(1);
  const PackedNorm norm(w[0], w[1]);
  const PackedLinear hidden(w[2], w[3]), output(w[4], w[5]), projection(w[6], w[7]);
  at::Tensor out = at::empty_like(x);
  at::parallel_for(0, n, kMinNormPart / 4, [&](int64_t begin, int64_t end) {
    Tile from(kNormTile, A), input(kNormTile, C), normed(kNormTile, C),
        activation(kNormTile, kPanel);
    over_tiles(begin, end, [&](int64_t first, int64_t rows) {
      load_rows(x.const_data_ptr<float>(), C, first, rows, input);
      load_rows(attended.const_data_ptr<float>(), A, first, rows, from);
      dense(projection, from, rows, true, input);
      norm.apply(input, rows, C, normed);
      perceptron(hidden, output, normed, rows, true, activation, input);
      store_rows(input, C, first, rows, out.data_ptr<float>());
    });
  });
  return out;
}

std::tuple<at::Tensor, at::Tensor, std::vector<at::Tensor>> project_feed_forward_backward_cpu(
    const at::Tensor& any_grad, const at::Tensor& any_x, const at::Tensor& any_attended,
    at::TensorList w) {
  check_project_feed_forward(any_x, any_attended, w);
  const at::Tensor grad = any_grad.contiguous(), x = any_x.contiguous(),
                   attended = any_attended.contiguous();
  const int64_t n = x.size(0), C = x.size(1), A = attended.size(1);
  check_shape(grad, x.sizes(), at::kFloat, "project_feed_forward_backward", "grad");
  const PackedNorm norm(w[0], w[1]);
  const Perceptron net({{w[2], w[3]}, {w[4], w[5]}});
  const Layer projection({w[6], w[7]});
  const int64_t width = net.hidden.forward.outputs;
  at::Tensor by_x = at::empty_like(x), by_attended = at::empty_like(attended);
  const RowParts parts(n, kMinNormPart);
  struct Sums {
    NormSums norm;
    PerceptronSums net;
    LinearGradient projection;
  };
  std::vector<Sums> sums(static_cast<size_t>(parts.parts),
                         {NormSums(norm), PerceptronSums(net), LinearGradient(projection.forward)});
  at::parallel_for(0, parts.parts, 1, [&](int64_t begin, int64_t end) {
    Tile taken(kNormTile, A), input(kNormTile, C), normed(kNormTile, C), from(kNormTile, C),
        by_hidden(kNormTile, width), by_normed(kNormTile, C), by_taken(kNormTile, A);
    Hidden hidden(kNormTile, width);
    for (int64_t part = begin; part < end; ++part) {
      Sums& own = sums[static_cast<size_t>(part)];
      over_tiles(parts.begin(part), parts.begin(part + 1), [&](int64_t first, int64_t rows) {
        load_rows(x.const_data_ptr<float>(), C, first, rows, input);
        load_rows(attended.const_data_ptr<float>(), A, first, rows, taken);
        load_rows(grad.const_data_ptr<float>(), C, first, rows, from);
        dense(projection.forward, taken, rows, true, input);
        norm.apply(input, rows, C, normed);
        activate(net, normed, rows, hidden);
        return_through(net, from, normed, hidden, rows, false, own.net, by_hidden, &by_normed);
        add_norm_gradient(norm, input, by_normed, rows, C, from, own.norm);
        store_rows(from, C, first, rows, by_x.data_ptr<float>());
        own.projection.add(from, taken, rows);
        dense(projection.backward, from, rows, false, by_taken);
        store_rows(by_taken, A, first, rows, by_attended.data_ptr<float>());
      });
    }
  });
  const std::vector<at::Tensor> out = room_for(w);
  for (const Sums& part : sums) {
    const bool add = &part != &sums.front();
    part.norm.write({out[0], out[1]}, add);
    part.net.write({{out[2], out[3]}, {out[4], out[5]}}, add);
    part.projection.write(out[6], out[7], add);
  }
  return {by_x, by_attended, out};
}

}  // namespace
}  // namespace lte::ops

TORCH_LIBRARY_IMPL(lte, CPU, m) {
  m.impl("layer_norm", lte::ops::layer_norm_cpu);
  m.impl("norm_linear", lte::ops::norm_linear_cpu);
  m.impl("norm_linear_backward", lte::ops::norm_linear_backward_cpu);
  m.impl("project_feed_forward", lte::ops::project_feed_forward_cpu);
  m.impl("project_feed_forward_backward", lte::ops::project_feed_forward_backward_cpu);
}
