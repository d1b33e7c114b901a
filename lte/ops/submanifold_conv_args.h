// What the submanifold convolution, its neighbour map and its gradients accept.
#pragma once

#include <algorithm>
#include <optional>

#include "lte/ops/arguments.h"
#include "lte/ops/submanifold_conv.h"

namespace lte::ops {

inline void check_convolution_pairs_args(const at::Tensor& cells, int64_t kernel) {
  const char* op = "convolution_pairs";
  TORCH_CHECK(kernel >= 1 && kernel <= 31 && kernel % 2 == 1, op,
              ": kernel must be odd, 1 to 31, got ", kernel);
  check_cells(cells, kConvolutionCellBits, op);
}

/// What convolution_pairs() returns for `taps` taps and N points. Rows are looked at on the CPU
/// alone.
inline void check_pairs(const at::Tensor& pairs, const at::Tensor& tap_begin, int64_t taps,
                        const at::Tensor& input, const char* op) {
  TORCH_CHECK(pairs.dim() == 2 && pairs.size(0) == 2 && pairs.scalar_type() == at::kInt &&
                  pairs.is_contiguous(),
              op, ": pairs must be [2, P] int32, contiguous, got ", pairs.sizes(), " ",
              pairs.scalar_type());
  check_device(pairs, "pairs", input, "rows of the input", op);
  TORCH_CHECK(
      tap_begin.dim() == 1 && tap_begin.size(0) == taps + 1 &&
          tap_begin.scalar_type() == at::kLong && tap_begin.is_contiguous() && tap_begin.is_cpu(),
      op, ": tap_begin must be [taps + 1] int64 on the CPU with the weight's ", taps, " taps, got ",
      tap_begin.sizes(), " ", tap_begin.scalar_type(), " on ", tap_begin.device());
  const int64_t P = pairs.size(1), N = input.size(0);
  const auto* begin = tap_begin.const_data_ptr<int64_t>();
  TORCH_CHECK(begin[0] == 0 && begin[taps] == P && std::is_sorted(begin, begin + taps + 1), op,
              ": tap_begin does not divide the ", P, " pairs");
  if (!pairs.is_cpu()) return;
  const auto* rows = pairs.const_data_ptr<int32_t>();
  const int64_t bad = first_row(2 * P, [&](int64_t i) { return rows[i] < 0 || rows[i] >= N; });
  TORCH_CHECK(bad == 2 * P, op, ": pair ", bad % std::max<int64_t>(P, 1), " names row ", rows[bad],
              " of an input of ", N, " rows");
  for (int64_t tap = 0; tap < taps; ++tap) {
    TORCH_CHECK(std::is_sorted(rows + begin[tap], rows + begin[tap + 1]), op, ": pairs of tap ",
                tap, " are not sorted by output");
  }
}

/// input [N, Cin] and weight [taps, Cin, Cout] on one device.
inline void check_convolution_shapes(const at::Tensor& input, const at::Tensor& weight,
                                     const char* op) {
  TORCH_CHECK(input.dim() == 2, op, ": input must be [N, Cin], got ", input.sizes());
  TORCH_CHECK(weight.dim() == 3 && weight.size(1) == input.size(1), op,
              ": weight must be [taps, Cin, Cout] with Cin = ", input.size(1), ", got ",
              weight.sizes());
  check_device(weight, "weights", input, "rows of the input", op);
}

inline void check_convolution_types(const at::Tensor& input, const at::Tensor& weight,
                                    const char* op) {
  TORCH_CHECK((input.scalar_type() == at::kFloat || input.scalar_type() == at::kDouble) &&
                  weight.scalar_type() == input.scalar_type(),
              op, ": input and weight must both be float32 or float64, got ", input.scalar_type(),
              " and ", weight.scalar_type());
}

inline void check_submanifold_conv_args(const at::Tensor& input, const at::Tensor& weight,
                                        const std::optional<at::Tensor>& bias,
                                        const at::Tensor& pairs, const at::Tensor& tap_begin) {
  const char* op = "submanifold_conv";
  check_convolution_shapes(input, weight, op);
  const int64_t Cout = weight.size(2);
  if (input.scalar_type() == at::kFloat && weight.scalar_type() == at::kBFloat16) {
    TORCH_CHECK(Cout % kConvolutionBlock == 0, op, ": bfloat16 weights need a multiple of ",
                kConvolutionBlock, " output channels, got ", Cout);
  } else {
    check_convolution_types(input, weight, op);
  }
  check_pairs(pairs, tap_begin, weight.size(0), input, op);
  if (!bias.has_value() || !bias->defined()) return;
  TORCH_CHECK(bias->dim() == 1 && bias->size(0) == Cout &&
                  bias->scalar_type() == input.scalar_type() && bias->is_contiguous(),
              op, ": bias must be [", Cout, "] of the input's dtype, contiguous, got ",
              bias->sizes(), " ", bias->scalar_type());
  check_device(*bias, "the bias", input, "rows of the input", op);
}

/// Input and weight of one dtype, which may be bfloat16 with a float32 gradient.
inline void check_submanifold_conv_backward_args(const at::Tensor& grad, const at::Tensor& input,
                                                 const at::Tensor& weight, const at::Tensor& pairs,
                                                 const at::Tensor& tap_begin) {
  const char* op = "submanifold_conv_backward";
  check_convolution_shapes(input, weight, op);
  const bool bf16 = input.scalar_type() == at::kBFloat16;
  if (bf16) {
    TORCH_CHECK(weight.scalar_type() == at::kBFloat16 && weight.size(1) % kConvolutionBlock == 0 &&
                    weight.size(2) % kConvolutionBlock == 0,
                op, ": a bfloat16 input needs a bfloat16 weight with multiples of ",
                kConvolutionBlock, " channels, got ", weight.sizes(), " ", weight.scalar_type());
  } else {
    check_convolution_types(input, weight, op);
  }
  check_shape(grad, {input.size(0), weight.size(2)}, bf16 ? at::kFloat : input.scalar_type(), op,
              "grad");
  check_device(grad, "gradients", input, "rows of the input", op);
  check_pairs(pairs, tap_begin, weight.size(0), input, op);
}

}  // namespace lte::ops
