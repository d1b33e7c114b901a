// CUDA twin of farthest_point_sampling: one persistent block that keeps every point's distance in
// global memory.
#include <tuple>

#include <ATen/core/Tensor.h>
#include <ATen/ops/empty.h>
#include <ATen/ops/full.h>
#include <c10/cuda/CUDAException.h>
#include <c10/cuda/CUDAGuard.h>
#include <c10/cuda/CUDAStream.h>
#include <torch/library.h>

#include "lte/ops/farthest_point_args.h"

namespace lte::ops {
namespace {

constexpr int kThreads = 1024;

struct Candidate {
  float dist2;
  int64_t index;
};

/// Farther wins; equal distances go to the lower index.
__device__ Candidate farther(Candidate a, Candidate b) {
  return (b.dist2 > a.dist2 || (b.dist2 == a.dist2 && b.index < a.index)) ? b : a;
}

__device__ Candidate block_farthest(Candidate mine) {
  __shared__ Candidate warps[kThreads / 32];
  __shared__ Candidate winner;
  for (int offset = 16; offset > 0; offset /= 2) {
    const Candidate other{__shfl_down_sync(0xffffffffu, mine.dist2, offset),
                          __shfl_down_sync(0xffffffffu, mine.index, offset)};
    mine = farther(mine, other);
  }
  if (threadIdx.x % 32 == 0) warps[threadIdx.x / 32] = mine;
  __syncthreads();
  if (threadIdx.x == 0) {
    Candidate best = warps[0];
    for (int w = 1; w < kThreads / 32; ++w) best = farther(best, warps[w]);
    winner = best;
  }
  __syncthreads();
  return winner;
}

__global__ void __launch_bounds__(kThreads)
    farthest_point_kernel(const float* points, float* nearest, int64_t* picks, float* insertion,
                          int64_t N, int64_t count) {
  int64_t last = 0;
  if (threadIdx.x == 0) {
    picks[0] = 0;
    insertion[0] = INFINITY;
  }
  for (int64_t pick = 1; pick < count; ++pick) {
    const float x = points[3 * last], y = points[3 * last + 1], z = points[3 * last + 2];
    Candidate mine{-1.0f, N};
    for (int64_t i = threadIdx.x; i < N; i += kThreads) {
      const float dx = points[3 * i] - x, dy = points[3 * i + 1] - y, dz = points[3 * i + 2] - z;
      const float d = __fadd_rn(__fadd_rn(__fmul_rn(dx, dx), __fmul_rn(dy, dy)), __fmul_rn(dz, dz));
      // A pick stays out of the race even when all that is left coincides with picks.
      float& best = nearest[i];
      if (i == last) best = -1.0f;
      if (d < best) best = d;
      mine = farther(mine, Candidate{best, i});
    }
    const Candidate winner = block_farthest(mine);
    last = winner.index;
    if (threadIdx.x == 0) {
      picks[pick] = last;
      insertion[pick] = winner.dist2;
    }
    __syncthreads();
  }
}

std::tuple<at::Tensor, at::Tensor> farthest_point_sampling_cuda(const at::Tensor& points,
                                                                int64_t count) {
  check_farthest_point_args(points, count);
  const c10::cuda::CUDAGuard guard(points.device());
  at::Tensor picks = at::empty({count}, points.options().dtype(at::kLong));
  at::Tensor insertion = at::empty({count}, points.options());
  if (count == 0) return {picks, insertion};
  at::Tensor nearest = at::full({points.size(0)}, INFINITY, points.options());
  farthest_point_kernel<<<1, kThreads, 0, c10::cuda::getCurrentCUDAStream()>>>(
      points.const_data_ptr<float>(), nearest.data_ptr<float>(), picks.data_ptr<int64_t>(),
      insertion.data_ptr<float>(), points.size(0), count);
  C10_CUDA_KERNEL_LAUNCH_CHECK();
  return {picks, insertion};
}

}  // namespace

TORCH_LIBRARY_IMPL(lte, CUDA, m) {
  m.impl("farthest_point_sampling", farthest_point_sampling_cuda);
}

}  // namespace lte::ops
