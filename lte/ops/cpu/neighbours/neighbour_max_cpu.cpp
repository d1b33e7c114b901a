// Maximum of a perceptron over neighbours, on the CPU: pairs in tiles that stay in the caches.
#include <algorithm>
#include <limits>

#include "lte/ops/cpu/dense/linear_gradient.h"
#include "lte/ops/cpu/dense/packed_linear.h"
#include "lte/ops/neighbour_max_args.h"
#include "lte/tensor/functions.h"
#include "lte/tensor/library.h"

namespace lte::ops {
namespace {

constexpr int64_t kMaxTile = 96;   ///< pairs at a time
constexpr int64_t kMinPart = 512;  ///< centres below which a second thread gains nothing

struct Work {
  const PackedLinear& layer;
  const float *dense, *center;
  const int64_t* neighbour;
  int64_t k;
  float* out;
  int32_t* winner;  ///< which pair each maximum is, or null
};

/// One thread's working memory.
class TileMaximum {
 public:
  explicit TileMaximum(const Work& work)
      : work_(work), input_(kMaxTile, work.layer.inputs), product_(kMaxTile, kPanel) {}

  /// Pairs [first, first + rows); the pairs of centre l are l * k to l * k + k.
  void run(int64_t first, int64_t rows) {
    const int64_t C = work_.layer.inputs, O = work_.layer.outputs;
    const auto activate_sum =
        work_.layer.in_bf16() ? bf16_kernels().activate_sum : dense_kernels().activate_sum;
    for (int64_t i = 0; i < rows; ++i) {
      if (i + kAhead < rows) fetch(work_.neighbour[first + i + kAhead]);
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
        const int64_t at = (first + i) / work_.k * O + p * kPanel;
        const float* x = product_.panel(0) + i * kPanel;
        if (work_.winner == nullptr) {
          dense_kernels().maximize(x, count, work_.out + at);
        } else {
          gradient_kernels().maximize_at(x, static_cast<int32_t>((first + i) % work_.k), count,
                                         work_.out + at, work_.winner + at);
        }
      }
    }
  }

 private:
  /// Calls a row of `dense` into the cache: rows come in no order that the processor could foresee.
  void fetch(int64_t row) const {
    constexpr int64_t kLine = 64 / sizeof(float);
    const float* x = work_.dense + row * work_.layer.inputs;
    for (int64_t c = 0; c < work_.layer.inputs; c += kLine) __builtin_prefetch(x + c);
  }

  static constexpr int64_t kAhead = 4;  ///< pairs between the call and the use
  const Work& work_;
  Tile input_, product_;
};

at::Tensor maxima(const at::Tensor& any_dense, const at::Tensor& any_center,
                  const at::Tensor& any_neighbour, const at::Tensor& weight, const at::Tensor& bias,
                  int32_t* winner) {
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
                  out.data_ptr<float>(),
                  winner};
  at::parallel_for(0, m, 16, [&](int64_t begin, int64_t end) {
    TileMaximum tile(work);
    for (int64_t pair = begin * k; pair < end * k; pair += kMaxTile) {
      tile.run(pair, std::min(kMaxTile, end * k - pair));
    }
  });
  return out;
}

at::Tensor neighbour_max_inference_cpu(const at::Tensor& dense, const at::Tensor& center,
                                       const at::Tensor& neighbour, const at::Tensor& weight,
                                       const at::Tensor& bias) {
  check_neighbour_max_args(dense, center, neighbour, weight, bias);
  return maxima(dense, center, neighbour, weight, bias, nullptr);
}

std::tuple<at::Tensor, at::Tensor> neighbour_max_cpu(const at::Tensor& dense,
                                                     const at::Tensor& center,
                                                     const at::Tensor& neighbour,
                                                     const at::Tensor& weight,
                                                     const at::Tensor& bias) {
  check_neighbour_max_training_args(dense, center, neighbour, weight, bias);
  at::Tensor winner = at::zeros({center.size(0), weight.size(0)}, center.options().dtype(at::kInt));
  at::Tensor out = maxima(dense, center, neighbour, weight, bias, winner.data_ptr<int32_t>());
  return {out, winner};
}

std::tuple<at::Tensor, at::Tensor, at::Tensor, at::Tensor> neighbour_max_backward_cpu(
    const at::Tensor& any_grad, const at::Tensor& any_dense, const at::Tensor& any_center,
    const at::Tensor& any_neighbour, const at::Tensor& any_weight, const at::Tensor& winner) {
  check_neighbour_max_backward_args(any_grad, any_dense, any_center, any_neighbour, any_weight,
                                    winner);
  const at::Tensor grad = any_grad.contiguous(), dense = any_dense.contiguous(),
                   center = any_center.contiguous(), neighbour = any_neighbour.contiguous(),
                   weight = any_weight.to(at::kFloat).contiguous();
  const int64_t m = center.size(0), k = neighbour.size(1), C = weight.size(1), O = weight.size(0);
  const RowParts parts(m, kMinPart);
  at::Tensor by_dense = at::zeros({parts.parts, dense.size(0), C}, dense.options()),
             by_center = at::zeros_like(center),
             by_weight = at::zeros({parts.parts, O, C}, weight.options());
  at::parallel_for(0, parts.parts, 1, [&](int64_t first_part, int64_t last_part) {
    std::vector<float> room(static_cast<size_t>(3 * k * C));
    std::vector<uint8_t> seen(static_cast<size_t>(k));
    for (int64_t part = first_part; part < last_part; ++part) {
      for (int64_t l = parts.begin(part); l < parts.begin(part + 1); ++l) {
        gradient_kernels().maximum_gradient(
            {dense.const_data_ptr<float>(), center.const_data_ptr<float>() + l * C,
             neighbour.const_data_ptr<int64_t>() + l * k, k, C, weight.const_data_ptr<float>(), O,
             winner.const_data_ptr<int32_t>() + l * O, grad.const_data_ptr<float>() + l * O,
             room.data(), room.data() + k * C, room.data() + 2 * k * C, seen.data(),
             by_dense.data_ptr<float>() + part * dense.numel(), by_center.data_ptr<float>() + l * C,
             by_weight.data_ptr<float>() + part * O * C});
      }
    }
  });
  const auto total = [](const at::Tensor& of_parts) {
    return of_parts.size(0) == 1 ? of_parts[0] : of_parts.sum(0);
  };
  return {total(by_dense), by_center, total(by_weight), grad.sum(0)};
}

}  // namespace
}  // namespace lte::ops

TORCH_LIBRARY_IMPL(lte, CPU, m) {
  m.impl("neighbour_max_inference", lte::ops::neighbour_max_inference_cpu);
  m.impl("neighbour_max", lte::ops::neighbour_max_cpu);
  m.impl("neighbour_max_backward", lte::ops::neighbour_max_backward_cpu);
}
