// solve_light on CUDA: a thread for the direct light of a point, and one for a sender and what it
// gives to a receiver.
#include <cstdint>

#include <ATen/core/Tensor.h>
#include <c10/cuda/CUDAException.h>
#include <c10/cuda/CUDAGuard.h>
#include <c10/cuda/CUDAStream.h>
#include <torch/library.h>

#include "lte/ops/solve_light_twin.h"

namespace lte::ops {
namespace {

constexpr int kThreads = 128;

unsigned blocks_for(int64_t threads) {
  return static_cast<unsigned>((threads + kThreads - 1) / kThreads);
}

__global__ void __launch_bounds__(kThreads)
    direct_kernel(const LitView view, const int64_t* rows, int64_t count, float* light) {
  const int64_t k = static_cast<int64_t>(blockIdx.x) * kThreads + threadIdx.x;
  if (k < count) direct_at(view, rows[k], light + 6 * k);
}

__global__ void __launch_bounds__(kThreads)
    links_kernel(const LitView view, const int64_t* rows, int64_t count, const int64_t* senders,
                 const float* areas, int64_t S, float* links) {
  const int64_t pair = static_cast<int64_t>(blockIdx.x) * kThreads + threadIdx.x;
  if (pair >= count * S) return;
  const int64_t row = pair / S, s = pair % S;
  const Transfer t = link_of(view, rows[row], senders[s], areas[s]);
  if (t.weight > 0) links[(2 * row + t.to_back) * 2 * S + t.from_back * S + s] = t.weight;
}

struct CudaKernels {
  void direct(const LitView& view, const at::Tensor& rows, const at::Tensor& light) const {
    direct_kernel<<<blocks_for(rows.size(0)), kThreads, 0, c10::cuda::getCurrentCUDAStream()>>>(
        view, rows.const_data_ptr<int64_t>(), rows.size(0), light.data_ptr<float>());
    C10_CUDA_KERNEL_LAUNCH_CHECK();
  }
  void links(const LitView& view, const at::Tensor& rows, const at::Tensor& senders,
             const at::Tensor& areas, const at::Tensor& links) const {
    const int64_t S = senders.size(0);
    links_kernel<<<blocks_for(rows.size(0) * S), kThreads, 0, c10::cuda::getCurrentCUDAStream()>>>(
        view, rows.const_data_ptr<int64_t>(), rows.size(0), senders.const_data_ptr<int64_t>(),
        areas.const_data_ptr<float>(), S, links.data_ptr<float>());
    C10_CUDA_KERNEL_LAUNCH_CHECK();
  }
};

at::Tensor solve_light_cuda(const at::Tensor& position, const at::Tensor& normal,
                            const at::Tensor& albedo, const at::Tensor& emission,
                            const at::Tensor& area) {
  check_solve_light_args(position, normal, albedo, emission, area);
  const c10::cuda::CUDAGuard guard(position.device());
  return LightTwin(position, normal, albedo, emission, area, CudaKernels()).run();
}

}  // namespace
}  // namespace lte::ops

TORCH_LIBRARY_IMPL(lte, CUDA, m) { m.impl("solve_light", lte::ops::solve_light_cuda); }
