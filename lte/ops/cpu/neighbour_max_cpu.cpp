// Maximum of a perceptron over neighbours, on the CPU: pairs in tiles that stay in the caches.
#include <algorithm>
#include <limits>

#include <ATen/Parallel.h>
#include <ATen/ops/full.h>
#include <torch/library.h>

#include "lte/ops/cpu/packed_linear.h"
#include "lte/ops/neighbour_max_args.h"

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

  /// Pairs [first, first + rows); the pairs of centre l are l * k to l * k + k.
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
  check_neighbour_max_args(any_dense, any_center, any_neighbour, weight, bias);
  const at::Tensor dense = any_dense.contiguous(), center = any_center.contiguous(),
                   neighbour = any_neighbour.contiguous();
  const int64_t m = center.size(0), k = neighbour.size(1);
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
