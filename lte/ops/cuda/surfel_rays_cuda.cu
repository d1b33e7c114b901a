// see_surfels on CUDA: a thread walks a ray.
#include <cstdint>

#include <ATen/core/Tensor.h>
#include <ATen/ops/empty.h>
#include <c10/cuda/CUDAException.h>
#include <c10/cuda/CUDAGuard.h>
#include <c10/cuda/CUDAStream.h>
#include <torch/library.h>

#include "lte/ops/surfel_rays_args.h"

namespace lte::ops {
namespace {

constexpr int kRayThreads = 128;

__global__ void __launch_bounds__(kRayThreads)
    see_kernel(const SurfelView view, const float* position, const float* directions, int64_t rays,
               int64_t N, float* seen) {
  const int64_t i = static_cast<int64_t>(blockIdx.x) * kRayThreads + threadIdx.x;
  if (i >= rays) return;
  see(view, PlainCells(), {triple_at(position + i / N * 3), triple_at(directions + 3 * i)},
      seen + i * kSeenColumns);
}

at::Tensor see_surfels_cuda(const at::Tensor& any_position, const at::Tensor& any_directions,
                            const at::Tensor& discs, const at::Tensor& geometry,
                            const at::Tensor& first, const at::Tensor& member,
                            at::ArrayRef<double> numbers, at::IntArrayRef size) {
  const c10::cuda::CUDAGuard guard(any_position.device());
  const at::Tensor position = any_position.contiguous(), directions = any_directions.contiguous();
  const SurfelGrid grid = grid_of(discs, geometry, first, member, numbers, size);
  check_see_surfels_args(position, directions, grid);
  const int64_t Q = directions.size(0), N = directions.size(1), rays = Q * N;
  at::Tensor out = at::empty({Q, N, kSeenColumns}, position.options());
  if (rays == 0) return out;
  see_kernel<<<static_cast<unsigned>((rays + kRayThreads - 1) / kRayThreads), kRayThreads, 0,
               c10::cuda::getCurrentCUDAStream()>>>(view_of(grid), position.const_data_ptr<float>(),
                                                    directions.const_data_ptr<float>(), rays, N,
                                                    out.data_ptr<float>());
  C10_CUDA_KERNEL_LAUNCH_CHECK();
  return out;
}

}  // namespace

TORCH_LIBRARY_IMPL(lte, CUDA, m) { m.impl("see_surfels", see_surfels_cuda); }

}  // namespace lte::ops
