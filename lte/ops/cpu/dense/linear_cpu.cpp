// Dense layers on the CPU: float32 in and out, products of float32 or of operands rounded to
// bfloat16. Threads take tiles of rows and panels of outputs.
#include <algorithm>
#include <optional>
#include <vector>

#include "lte/ops/cpu/dense/packed_linear.h"
#include "lte/ops/linear_args.h"
#include "lte/tensor/functions.h"
#include "lte/tensor/library.h"

namespace lte::ops {
namespace {

constexpr int64_t kTile = 96;  ///< rows

/// One thread's working memory.
class TileLinear {
 public:
  TileLinear(const float* x, const PackedLinear& layer, bool gelu, float* out)
      : x_(x),
        layer_(layer),
        gelu_(gelu),
        out_(out),
        input_(kTile, kPanel),
        answer_(kTile, kPanel) {}

  /// Rows [first, first + rows), at most kTile, of one panel.
  void run(int64_t first, int64_t rows, int64_t panel) {
    const int64_t C = layer_.inputs, O = layer_.outputs;
    const int64_t block = panel * (kPanel / kBlock);
    const int64_t blocks = std::min(layer_.blocks - block, kPanel / kBlock);
    for (int64_t k = 0; k < C; k += kPanel) {
      const int64_t count = std::min(kPanel, C - k);
      const float* from = x_ + first * C + k;
      if (C != kPanel) from = gather(from, rows, count);
      layer_.multiply(from, rows, k, count, block, blocks, k == 0, k > 0, answer_.panel(0));
    }
    if (gelu_) {
      const auto activate = layer_.in_bf16() ? bf16_kernels().activate : dense_kernels().activate;
      activate(answer_.panel(0), rows, blocks);
    }
    const int64_t columns = std::min(kPanel, O - panel * kPanel);
    for (int64_t i = 0; i < rows; ++i) {
      copy_row(answer_.panel(0) + i * kPanel, columns, out_ + (first + i) * O + panel * kPanel);
    }
  }

 private:
  /// `count` columns of `rows` rows as a panel.
  const float* gather(const float* from, int64_t rows, int64_t count) {
    for (int64_t i = 0; i < rows; ++i)
      copy_row(from + i * layer_.inputs, count, input_.panel(0) + i * kPanel);
    return input_.panel(0);
  }

  const float* x_;
  const PackedLinear& layer_;
  bool gelu_;
  float* out_;
  Tile input_, answer_;
};

at::Tensor linear_rows_cpu(const at::Tensor& any_x, const at::Tensor& weight,
                           const std::optional<at::Tensor>& bias, bool gelu) {
  check_linear_rows_args(any_x, weight, bias);
  const int64_t O = weight.size(0), C = weight.size(1);
  const at::Tensor x = any_x.contiguous();
  std::vector<int64_t> shape = x.sizes().vec();
  shape.back() = O;
  at::Tensor out = at::empty(shape, x.options());
  if (out.numel() == 0) return out;
  const PackedLinear layer(weight, bias.value_or(at::Tensor()));
  const int64_t rows = x.numel() / C, panels = panels_of(O), tiles = (rows + kTile - 1) / kTile;
  const auto* from = x.const_data_ptr<float>();
  auto* to = out.data_ptr<float>();
  at::parallel_for(0, tiles * panels, 1, [&](int64_t begin, int64_t end) {
    TileLinear linear(from, layer, gelu, to);
    for (int64_t i = begin; i < end; ++i) {
      const int64_t first = i / panels * kTile;
      linear.run(first, std::min(kTile, rows - first), i % panels);
    }
  });
  return out;
}

}  // namespace
}  // namespace lte::ops

TORCH_LIBRARY_IMPL(lte, CPU, m) { m.impl("linear_rows", lte::ops::linear_rows_cpu); }
