// lobe_radiance_inference on CUDA: a block of threads takes some directions from the lobes to
// the answer, and a thread one lobe, mixture or channel of a direction at a time. Lobes and
// mixtures lie in shared memory.
#include <algorithm>
#include <cstdint>
#include <optional>

#include <ATen/core/Tensor.h>
#include <ATen/ops/empty.h>
#include <c10/cuda/CUDAException.h>
#include <c10/cuda/CUDAGuard.h>
#include <c10/cuda/CUDAStream.h>
#include <cuda_bf16.h>
#include <torch/library.h>

#include "lte/ops/lobe_radiance_args.h"

namespace lte::ops {
namespace {

constexpr int kThreads = 128;
constexpr int64_t kMaxRows = 16;                  ///< directions of a block
constexpr int64_t kSharedFloats = 48 * 1024 / 4;  ///< that any device has for a block

struct LobeArguments {
  const float* own;         ///< [Q, 5 K]
  const float* directions;  ///< [rows, 3]
  const float* light;       ///< [Q, 3], or nullptr
  const float* seen;        ///< [rows, kSeenColumns], or nullptr
  const float* mix;         ///< [K + F, K], transposed: threads read consecutive mixtures
  const float *mix_bias, *color, *color_bias;
  float* out;  ///< [rows, 3]
  int64_t rows, N;
  int K, F, rows_of_block;
  bool rounded;  ///< what the mixture reads is rounded to bfloat16, as its weights have been
};

__device__ __forceinline__ float lobe_gelu(float x) {
  return 0.5f * x * (1 + erff(x * 0.70710678118654752f));
}

__device__ __forceinline__ float softplus(float x) { return x > 20 ? x : log1pf(expf(x)); }

/// Softplus of output `o` of color.
__device__ __forceinline__ float factor(const LobeArguments& a, const float* mixed, int o) {
  float sum = a.color_bias[o];
  for (int k = 0; k < a.K; ++k) sum = fmaf(a.color[o * a.K + k], mixed[k], sum);
  return softplus(sum);
}

__global__ void __launch_bounds__(kThreads) lobe_kernel(const LobeArguments a) {
  extern __shared__ float shared[];
  const int inputs = a.K + a.F, thread = static_cast<int>(threadIdx.x);
  float* const input = shared;                             // [rows_of_block, K + F]
  float* const mixed = shared + a.rows_of_block * inputs;  // [rows_of_block, K]
  const int64_t first = static_cast<int64_t>(blockIdx.x) * a.rows_of_block;
  const int count = static_cast<int>(min(static_cast<int64_t>(a.rows_of_block), a.rows - first));
  for (int i = thread; i < count * inputs; i += kThreads) {
    const int64_t row = first + i / inputs;
    const int k = i % inputs;
    const float* own = a.own + row / a.N * 5 * a.K;
    float value;
    if (k < a.K) {
      value = own[3 * a.K + k];
      for (int axis = 0; axis < 3; ++axis)
        value = fmaf(own[3 * k + axis], a.directions[3 * row + axis], value);
      value = lobe_gelu(value);
    } else {
      value = a.seen[row * kSeenColumns + kSeenLog + k - a.K];
    }
    input[i] = a.rounded ? __bfloat162float(__float2bfloat16_rn(value)) : value;
  }
  __syncthreads();
  for (int i = thread; i < count * a.K; i += kThreads) {
    const int r = i / a.K, k = i % a.K;
    float sum = a.own[(first + r) / a.N * 5 * a.K + 4 * a.K + k] + a.mix_bias[k];
    for (int j = 0; j < inputs; ++j) sum = fmaf(a.mix[j * a.K + k], input[r * inputs + j], sum);
    mixed[i] = lobe_gelu(sum);
  }
  __syncthreads();
  for (int i = thread; i < count * 3; i += kThreads) {
    const int r = i / 3, c = i % 3;
    const int64_t row = first + r;
    float sum = factor(a, mixed + r * a.K, c);
    if (a.light != nullptr) sum *= a.light[row / a.N * 3 + c];
    if (a.seen != nullptr)
      sum = fmaf(factor(a, mixed + r * a.K, 3 + c), a.seen[row * kSeenColumns + kSeenRadiance + c],
                 sum);
    a.out[3 * row + c] = sum;
  }
}

at::Tensor lobe_radiance_inference_cuda(const at::Tensor& any_own, const at::Tensor& any_directions,
                                        const std::optional<at::Tensor>& any_light,
                                        const std::optional<at::Tensor>& any_seen,
                                        const at::Tensor& mix_weight,
                                        const at::Tensor& any_mix_bias,
                                        const at::Tensor& any_color_weight,
                                        const at::Tensor& any_color_bias) {
  const at::Tensor own = any_own.contiguous(), directions = any_directions.contiguous(),
                   light = contiguous_or_undefined(any_light),
                   seen = contiguous_or_undefined(any_seen);
  const LobeSizes sizes =
      check_lobe_radiance_args(own, directions, light, seen,
                               {{mix_weight, any_mix_bias}, {any_color_weight, any_color_bias}});
  const int64_t K = sizes.lobes, F = sizes.features, floats = 2 * K + F;
  TORCH_CHECK(floats <= kSharedFloats, "lobe_radiance_inference: at most ", (kSharedFloats - F) / 2,
              " lobes on CUDA, got ", K);
  const c10::cuda::CUDAGuard guard(own.device());
  at::Tensor out = at::empty({sizes.points, sizes.directions, 3}, own.options());
  if (sizes.rows() == 0) return out;
  const at::Tensor mix = mix_weight.to(at::kFloat).t().contiguous(),
                   mix_bias = any_mix_bias.contiguous(), color = any_color_weight.contiguous(),
                   color_bias = any_color_bias.contiguous();
  const int64_t rows = std::min(kMaxRows, kSharedFloats / floats);
  const LobeArguments arguments{own.const_data_ptr<float>(),
                                directions.const_data_ptr<float>(),
                                light.defined() ? light.const_data_ptr<float>() : nullptr,
                                seen.defined() ? seen.const_data_ptr<float>() : nullptr,
                                mix.const_data_ptr<float>(),
                                mix_bias.const_data_ptr<float>(),
                                color.const_data_ptr<float>(),
                                color_bias.const_data_ptr<float>(),
                                out.data_ptr<float>(),
                                sizes.rows(),
                                sizes.directions,
                                static_cast<int>(K),
                                static_cast<int>(F),
                                static_cast<int>(rows),
                                mix_weight.scalar_type() == at::kBFloat16};
  lobe_kernel<<<static_cast<unsigned>((sizes.rows() + rows - 1) / rows), kThreads,
                static_cast<size_t>(rows * floats) * sizeof(float),
                c10::cuda::getCurrentCUDAStream()>>>(arguments);
  C10_CUDA_KERNEL_LAUNCH_CHECK();
  return out;
}

}  // namespace

TORCH_LIBRARY_IMPL(lte, CUDA, m) {
  m.impl("lobe_radiance_inference", lobe_radiance_inference_cuda);
}

}  // namespace lte::ops
