// knn on CUDA: exact, by brute force over tiles in shared memory. Up to 32 neighbours a warp
// has a query, and each of its lanes holds one of the nearest so far, in their order (Johnson et
// al. 2017, "Billion-scale similarity search with GPUs", section 4.2); of more a thread has a
// query.
//
// Points are scanned in ascending index and a candidate enters only if it is strictly nearer than
// the k-th so far, so equal distances resolve to the lower index as on the CPU.
#include <algorithm>
#include <climits>
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

constexpr int kThreads = 128;  ///< of a block whose threads have a query each
constexpr int kWarp = 32, kWarps = 8, kTile = kWarps * kWarp;  ///< of one whose warps have

/// Distances must not be contracted to fused multiply-adds: the CPU's are not, and ties depend on
/// the last bit.
__device__ float squared_distance(float dx, float dy, float dz) {
  return __fadd_rn(__fadd_rn(__fmul_rn(dx, dx), __fmul_rn(dy, dy)), __fmul_rn(dz, dz));
}

/// One of a warp's nearest points, or none yet: at infinity, after all that are.
struct Near {
  float dist2 = INFINITY;
  int index = INT_MAX;

  __device__ __forceinline__ bool before(const Near& other) const {
    return dist2 < other.dist2 || (dist2 == other.dist2 && index < other.index);
  }
};

__device__ __forceinline__ Near of_lane(const Near& mine, int lane) {
  return {__shfl_sync(0xffffffffu, mine.dist2, lane), __shfl_sync(0xffffffffu, mine.index, lane)};
}

/// Puts a candidate into its place among those of the warp, whose last one falls out.
__device__ __forceinline__ void insert(const Near& candidate, int lane, Near* mine) {
  const int slot = __popc(__ballot_sync(0xffffffffu, mine->before(candidate)));
  const Near up = {__shfl_up_sync(0xffffffffu, mine->dist2, 1),
                   __shfl_up_sync(0xffffffffu, mine->index, 1)};
  if (lane > slot) *mine = up;
  if (lane == slot) *mine = candidate;
}

/// k <= 32 and k <= N.
__global__ void __launch_bounds__(kTile)
    knn_of_warps(const float* queries, const float* points, int64_t* index, float* dist2, int64_t Q,
                 int N, int k) {
  __shared__ float tile[3 * kTile];
  const int lane = static_cast<int>(threadIdx.x) % kWarp;
  const int64_t q = static_cast<int64_t>(blockIdx.x) * kWarps + threadIdx.x / kWarp;
  const bool active = q < Q;
  float x = 0, y = 0, z = 0;
  if (active) {
    x = queries[3 * q];
    y = queries[3 * q + 1];
    z = queries[3 * q + 2];
  }
  Near mine, last;  // the lane's, and the k-th of the warp
  for (int base = 0; base < N; base += kTile) {
    const int count = min(kTile, N - base);
    __syncthreads();
    for (int i = static_cast<int>(threadIdx.x); i < 3 * count; i += kTile)
      tile[i] = points[3 * static_cast<int64_t>(base) + i];
    __syncthreads();
    if (!active) continue;
    for (int first = 0; first < count; first += kWarp) {
      const int i = first + lane;
      Near candidate;
      if (i < count) {
        // fminf: what is not a number is infinitely far.
        candidate.dist2 = fminf(
            squared_distance(x - tile[3 * i], y - tile[3 * i + 1], z - tile[3 * i + 2]), INFINITY);
        candidate.index = base + i;
      }
      unsigned nearer = __ballot_sync(0xffffffffu, candidate.before(last));
      while (nearer != 0) {
        const Near next = of_lane(candidate, __ffs(static_cast<int>(nearer)) - 1);
        nearer &= nearer - 1;
        if (!next.before(last)) continue;
        insert(next, lane, &mine);
        last = of_lane(mine, k - 1);
      }
    }
  }
  if (!active || lane >= k) return;
  index[q * k + lane] = mine.index;
  dist2[q * k + lane] = mine.dist2;
}

/// Lists live in the output rows: [Q, k], kept sorted by insertion.
__global__ void knn_of_threads(const float* queries, const float* points, int64_t* index,
                               float* dist2, int64_t Q, int64_t N, int k) {
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
  const auto stream = c10::cuda::getCurrentCUDAStream();
  const auto blocks = [Q](int64_t queries) {
    return static_cast<unsigned>((Q + queries - 1) / queries);
  };
  if (columns <= kWarp) {
    knn_of_warps<<<blocks(kWarps), kTile, 0, stream>>>(
        queries.const_data_ptr<float>(), points.const_data_ptr<float>(), index.data_ptr<int64_t>(),
        dist2.data_ptr<float>(), Q, static_cast<int>(N), static_cast<int>(columns));
  } else {
    knn_of_threads<<<blocks(kThreads), kThreads, 0, stream>>>(
        queries.const_data_ptr<float>(), points.const_data_ptr<float>(), index.data_ptr<int64_t>(),
        dist2.data_ptr<float>(), Q, N, static_cast<int>(columns));
  }
  C10_CUDA_KERNEL_LAUNCH_CHECK();
  return {index, dist2};
}

}  // namespace

TORCH_LIBRARY_IMPL(lte, CUDA, m) { m.impl("knn", knn_cuda); }

}  // namespace lte::ops
