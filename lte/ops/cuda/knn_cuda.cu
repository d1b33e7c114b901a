// CUDA twin of knn: exact, by brute force over shared-memory tiles, one thread a query.
//
// Points are scanned in ascending index and a candidate enters only if it is strictly nearer than
// the k-th so far, so equal distances resolve to the lower index as on the CPU.
#include <algorithm>
#include <tuple>

#include <ATen/core/Tensor.h>
#include <ATen/ops/empty.h>
#include <c10/cuda/CUDAException.h>
#include <c10/cuda/CUDAGuard.h>
#include <c10/cuda/CUDAStream.h>
#include <torch/library.h>

#include "lte/ops/knn_args.h"

namespace lte::ops {
namespace {

constexpr int kThreads = 128;

/// Distances must not be contracted to fused multiply-adds: the CPU's are not, and ties depend on
/// the last bit.
__device__ float squared_distance(float dx, float dy, float dz) {
  return __fadd_rn(__fadd_rn(__fmul_rn(dx, dx), __fmul_rn(dy, dy)), __fmul_rn(dz, dz));
}

/// Lists live in the output rows: [Q, k], kept sorted by insertion.
__global__ void knn_kernel(const float* queries, const float* points, int64_t* index, float* dist2,
                           int64_t Q, int64_t N, int k) {
  __shared__ float tile[3 * kThreads];
  const int64_t q = static_cast<int64_t>(blockIdx.x) * kThreads + threadIdx.x;
  const bool active = q < Q;
  float x = 0, y = 0, z = 0;
  if (active) {
    x = queries[3 * q];
    y = queries[3 * q + 1];
    z = queries[3 * q + 2];
  }
  int64_t* my_index = index + q * k;
  float* my_dist2 = dist2 + q * k;
  int filled = 0;
  float worst = INFINITY;
  for (int64_t base = 0; base < N; base += kThreads) {
    const int count = static_cast<int>(min(static_cast<int64_t>(kThreads), N - base));
    __syncthreads();
    for (int i = threadIdx.x; i < 3 * count; i += kThreads) tile[i] = points[3 * base + i];
    __syncthreads();
    if (!active) continue;
    for (int i = 0; i < count; ++i) {
      const float d = squared_distance(x - tile[3 * i], y - tile[3 * i + 1], z - tile[3 * i + 2]);
      if (filled == k && !(d < worst)) continue;
      int slot = filled < k ? filled++ : k - 1;
      for (; slot > 0 && my_dist2[slot - 1] > d; --slot) {
        my_dist2[slot] = my_dist2[slot - 1];
        my_index[slot] = my_index[slot - 1];
      }
      my_dist2[slot] = d;
      my_index[slot] = base + i;
      worst = my_dist2[filled - 1];
    }
  }
}

std::tuple<at::Tensor, at::Tensor> knn_cuda(const at::Tensor& queries, const at::Tensor& points,
                                            int64_t k) {
  check_knn_args(queries, points, k);
  const c10::cuda::CUDAGuard guard(points.device());
  const int64_t Q = queries.size(0), N = points.size(0), columns = std::min(k, N);
  at::Tensor index = at::empty({Q, columns}, points.options().dtype(at::kLong));
  at::Tensor dist2 = at::empty({Q, columns}, points.options());
  if (Q == 0 || columns == 0) return {index, dist2};
  knn_kernel<<<static_cast<unsigned>((Q + kThreads - 1) / kThreads), kThreads, 0,
               c10::cuda::getCurrentCUDAStream()>>>(
      queries.const_data_ptr<float>(), points.const_data_ptr<float>(), index.data_ptr<int64_t>(),
      dist2.data_ptr<float>(), Q, N, static_cast<int>(columns));
  C10_CUDA_KERNEL_LAUNCH_CHECK();
  return {index, dist2};
}

}  // namespace

TORCH_LIBRARY_IMPL(lte, CUDA, m) { m.impl("knn", knn_cuda); }

}  // namespace lte::ops
