// curve_codes on CUDA: one thread a cell.
#include <ATen/core/Tensor.h>
#include <ATen/ops/empty.h>
#include <c10/cuda/CUDAException.h>
#include <c10/cuda/CUDAGuard.h>
#include <c10/cuda/CUDAStream.h>
#include <torch/library.h>

#include "lte/ops/curve_codes_kernel.h"

namespace lte::ops {
namespace {

constexpr int kThreads = 256;

__global__ void curve_codes_kernel(const int32_t* cells, int64_t* codes, int64_t N, int curve,
                                   int bits) {
  const int64_t i = static_cast<int64_t>(blockIdx.x) * kThreads + threadIdx.x;
  if (i >= N) return;
  const int32_t* cell = cells + 3 * i;
  CUDA_KERNEL_ASSERT((cell[0] | cell[1] | cell[2]) >> bits == 0 && "a cell outside the range");
  codes[i] = curve_code(cell, static_cast<Curve>(curve), bits);
}

at::Tensor curve_codes_cuda(const at::Tensor& cells, int64_t curve, int64_t bits) {
  check_curve_codes_args(cells, curve, bits);
  const c10::cuda::CUDAGuard guard(cells.device());
  at::Tensor codes = at::empty({cells.size(0)}, cells.options().dtype(at::kLong));
  const int64_t N = cells.size(0);
  if (N == 0) return codes;
  curve_codes_kernel<<<static_cast<unsigned>((N + kThreads - 1) / kThreads), kThreads, 0,
                       c10::cuda::getCurrentCUDAStream()>>>(
      cells.const_data_ptr<int32_t>(), codes.data_ptr<int64_t>(), N, static_cast<int>(curve),
      static_cast<int>(bits));
  C10_CUDA_KERNEL_LAUNCH_CHECK();
  return codes;
}

}  // namespace

TORCH_LIBRARY_IMPL(lte, CUDA, m) { m.impl("curve_codes", curve_codes_cuda); }

}  // namespace lte::ops
