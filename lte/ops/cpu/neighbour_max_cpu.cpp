// Maximum of a perceptron over neighbours, on the CPU: pairs in tiles that stay in the caches.
#include <algorithm>
#include <limits>

#include <ATen/Parallel.h>
#include <ATen/ops/full.h>
#include <torch/library.h>

#include "lte/ops/arguments.h"
#include "lte/ops/cpu/packed_linear.h"

namespace lte::ops {
namespace {

constexpr int64_t kTile = 96;  ///< pairs at a time

struct Work {
  const PackedLinear& layer;
  const float *dense, *center;
  const int64_t* neighbour;
  int64_t k;
  float* out;
};

/// One thread's working memory.
class TileMaximum {
 public:
  explicit TileMaximum(const Work& work)
      : work_(work), input_(kTile, work.layer.inputs), product_(kTile, kPanel) {}

  /// Pairs [first, first + rows): those of centre l are l * k to l * k + k.
  void run(int64_t first, int64_t rows) {
    const int64_t C = work_.layer.inputs, O = work_.layer.outputs;
    const auto activate_sum =
        work_.layer.in_bf16() ? bf16_kernels().activate_sum : dense_kernels().activate_sum;
    for (int64_t i = 0; i < rows; ++i) {
      const float* x = work_.dense + work_.neighbour[first + i] * C;
      const float* center = work_.center + (first + i) / work_.k * C;
      for (int64_t c = 0; c < C; c += kPanel) {
        activate_sum(x + c, center + c, std::min(kPanel, C - c),
                     input_.panel(c / kPanel) + i * kPanel);
      }
    }
    for (int64_t p = 0; p < panels_of(O); ++p) {
      dense_panel(work_.layer, input_, rows, p, false, product_.panel(0));
      const int64_t count = std::min(kPanel, O - p * kPanel);
      for (int64_t i = 0; i < rows; ++i) {
        dense_kernels().maximize(product_.panel(0) + i * kPanel, count,
                                 work_.out + (first + i) / work_.k * O + p * kPanel);
      }
    }
  }

 private:
  const Work& work_;
  Tile input_, product_;
};

at::Tensor neighbour_max_inference_cpu(const at::Tensor& any_dense, const at::Tensor& any_center,
                                       const at::Tensor& any_neighbour, const at::Tensor& weight,
                                       const at::Tensor& bias) {
  const char* op = "neighbour_max_inference";
  TORCH_CHECK(weight.dim() == 2 && bias.dim() == 1 && bias.size(0) == weight.size(0), op,
              ": weight must be [O, C] and bias [O], got ", weight.sizes(), " and ", bias.sizes());
  const at::Tensor dense = any_dense.contiguous(), center = any_center.contiguous(),
                   neighbour = any_neighbour.contiguous();
  for (const at::Tensor& t : {dense, center}) {
    TORCH_CHECK(t.dim() == 2 && t.size(1) == weight.size(1), op, ": dense and center must be [., ",
                weight.size(1), "], got ", t.sizes());
  }
  TORCH_CHECK(weight.scalar_type() == at::kFloat || weight.scalar_type() == at::kBFloat16, op,
              ": weight must be float32 or bfloat16, got ", weight.scalar_type());
  for (const at::Tensor& t : {dense, center, bias}) {
    TORCH_CHECK(t.scalar_type() == at::kFloat, op, ": dense, center and bias must be float32, got ",
                t.scalar_type());
  }
  const int64_t m = center.size(0);
  check_neighbours(neighbour, m, dense.size(0), op);
  const int64_t k = neighbour.size(1);
  TORCH_CHECK(k >= 1, op, ": a maximum over no neighbours");
  const PackedLinear layer(weight, bias);
  const double lowest = -std::numeric_limits<double>::infinity();
  at::Tensor out = at::full({m, layer.outputs}, lowest, center.options());
  const Work work{layer,
                  dense.const_data_ptr<float>(),
                  center.const_data_ptr<float>(),
                  neighbour.const_data_ptr<int64_t>(),
                  k,
                  out.data_ptr<float>()};
  at::parallel_for(0, m, 16, [&](int64_t begin, int64_t end) {
    TileMaximum tile(work);
    for (int64_t pair = begin * k; pair < end * k; pair += kTile) {
      tile.run(pair, std::min(kTile, end * k - pair));
    }
  });
  return out;
}

}  // namespace
}  // namespace lte::ops

TORCH_LIBRARY_IMPL(lte, CPU, m) {
  m.impl("neighbour_max_inference", lte::ops::neighbour_max_inference_cpu);
}
