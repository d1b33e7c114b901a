// Codes along space-filling curves on the CPU.

#include "lte/ops/cpu/kernels/kernels.h"
#include "lte/ops/curve_codes_kernel.h"
#include "lte/tensor/functions.h"
#include "lte/tensor/library.h"

namespace lte::ops {
namespace {

at::Tensor curve_codes_cpu(const at::Tensor& cells, int64_t curve, int64_t bits) {
  check_curve_codes_args(cells, curve, bits);
  const int64_t N = cells.size(0);
  const auto* in = cells.const_data_ptr<int32_t>();
  at::Tensor codes = at::empty({N}, cells.options().dtype(at::kLong));
  auto* out = codes.data_ptr<int64_t>();
  const auto kind = static_cast<Curve>(curve);
  const bool hilbert = kind == Curve::Hilbert || kind == Curve::HilbertTransposed,
             transposed = kind == Curve::ZTransposed || kind == Curve::HilbertTransposed;
  at::parallel_for(0, N, kGrain, [&](int64_t begin, int64_t end) {
    curve_kernels().codes(in + 3 * begin, end - begin, hilbert, transposed, static_cast<int>(bits),
                          out + begin);
  });
  return codes;
}

}  // namespace
}  // namespace lte::ops

TORCH_LIBRARY_IMPL(lte, CPU, m) { m.impl("curve_codes", lte::ops::curve_codes_cpu); }
