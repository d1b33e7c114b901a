// On CUDA: the neighbour sums: one thread a query and channel, so that a warp reads
// consecutive channels of a latent.
#include <algorithm>
#include <tuple>

#include <ATen/Dispatch.h>
#include <ATen/core/Tensor.h>
#include <ATen/ops/arange.h>
#include <ATen/ops/empty.h>
#include <ATen/ops/empty_like.h>
#include <ATen/ops/linear.h>
#include <ATen/ops/searchsorted.h>
#include <ATen/ops/sort.h>
#include <ATen/ops/stack.h>
#include <ATen/ops/zeros_like.h>
#include <c10/cuda/CUDAException.h>
#include <c10/cuda/CUDAGuard.h>
#include <c10/cuda/CUDAStream.h>
#include <torch/library.h>

#include "lte/ops/neighbour_sums_args.h"

namespace lte::ops {
namespace {

constexpr int kThreads = 256;
/// Queries whose P, [queries, K, C], exists at a time: 64 MB at K = 32 and C = 128.
constexpr int64_t kInferenceBlock = 4096;

unsigned blocks_for(int64_t threads) {
  return static_cast<unsigned>((threads + kThreads - 1) / kThreads);
}

__device__ int64_t thread_index() {
  return static_cast<int64_t>(blockIdx.x) * kThreads + threadIdx.x;
}

/// The header promises it. The thread of the first channel looks, for all of its query or pair.
__device__ void assert_latent(int64_t latent, int64_t m) {
  CUDA_KERNEL_ASSERT(latent >= 0 && latent < m && "a neighbour outside the latents");
}

template <typename T>
__global__ void sums_kernel(const T* keys, const T* values, const T* position, const int64_t* index,
                            T* sum1, T* sum2, int64_t L, int64_t m, int64_t Q, int64_t K, int64_t C,
                            int64_t stride, int64_t first) {
  const int64_t i = thread_index();
  if (i >= Q * C) return;
  const int64_t q = i / C, c = i % C;
  if (c == 0) {
    for (int64_t k = 0; k < K; ++k) assert_latent(index[q * K + k], m);
  }
  for (int64_t l = 0; l < L; ++l) {
    T s1 = 0, s2 = 0;
    for (int64_t k = 0; k < K; ++k) {
      const int64_t at = (l * m + index[q * K + k]) * C + c;
      const T p = position[(q * K + k) * C + c];
      const T vp = values[at] + p;
      s1 += vp;
      s2 += (p - keys[at]) * vp;
    }
    sum1[(l * stride + first + q) * C + c] = s1;
    sum2[(l * stride + first + q) * C + c] = s2;
  }
}

/// Sums of queries [first, first + Q) into [L, stride, C].
void launch_sums(const at::Tensor& keys, const at::Tensor& values, const at::Tensor& position,
                 const at::Tensor& index, at::Tensor& sum1, at::Tensor& sum2, int64_t first) {
  const int64_t L = keys.size(0), m = keys.size(1), C = keys.size(2), Q = index.size(0),
                K = index.size(1);
  if (Q * C == 0) return;
  AT_DISPATCH_FLOATING_TYPES(keys.scalar_type(), "neighbour_sums", [&] {
    sums_kernel<scalar_t><<<blocks_for(Q * C), kThreads, 0, c10::cuda::getCurrentCUDAStream()>>>(
        keys.const_data_ptr<scalar_t>(), values.const_data_ptr<scalar_t>(),
        position.const_data_ptr<scalar_t>(), index.const_data_ptr<int64_t>(),
        sum1.data_ptr<scalar_t>(), sum2.data_ptr<scalar_t>(), L, m, Q, K, C, sum1.size(1), first);
    C10_CUDA_KERNEL_LAUNCH_CHECK();
  });
}

template <typename T>
__global__ void position_gradient_kernel(const T* grad1, const T* grad2, const T* keys,
                                         const T* values, const T* position, const int64_t* index,
                                         T* out, int64_t L, int64_t m, int64_t Q, int64_t K,
                                         int64_t C) {
  const int64_t i = thread_index();
  if (i >= Q * K * C) return;
  const int64_t pair = i / C, c = i % C, q = pair / K;
  if (c == 0) assert_latent(index[pair], m);
  const T p = position[i];
  T sum = 0;
  for (int64_t l = 0; l < L; ++l) {
    const int64_t at = (l * m + index[pair]) * C + c, query = (l * Q + q) * C + c;
    sum += grad1[query] + grad2[query] * (values[at] + p + p - keys[at]);
  }
  out[i] = sum;
}

/// `order` lists the pairs by latent; those of latent j are [begin[j], begin[j + 1]). One thread
/// adds all of them in that order, without atomics, so that the sums have the same bits each time.
template <typename T>
__global__ void table_gradient_kernel(const T* grad1, const T* grad2, const T* keys,
                                      const T* values, const T* position, const int64_t* order,
                                      const int64_t* begin, T* grad_keys, T* grad_values, int64_t L,
                                      int64_t m, int64_t Q, int64_t K, int64_t C) {
  const int64_t i = thread_index();
  if (i >= L * m * C) return;
  const int64_t l = i / (m * C), latent = i / C % m, c = i % C;
  T dk = 0, dv = 0;
  for (int64_t s = begin[latent]; s < begin[latent + 1]; ++s) {
    const int64_t pair = order[s], query = (l * Q + pair / K) * C + c;
    const T p = position[pair * C + c];
    dk -= grad2[query] * (values[i] + p);
    dv += grad1[query] + grad2[query] * (p - keys[i]);
  }
  grad_keys[i] = dk;
  grad_values[i] = dv;
}

std::tuple<at::Tensor, at::Tensor> neighbour_sums_cuda(const at::Tensor& keys,
                                                       const at::Tensor& values,
                                                       const at::Tensor& position,
                                                       const at::Tensor& index) {
  check_neighbour_sums_args(keys, values, position, index);
  const c10::cuda::CUDAGuard guard(keys.device());
  at::Tensor sum1 = at::empty({keys.size(0), index.size(0), keys.size(2)}, keys.options());
  at::Tensor sum2 = at::empty_like(sum1);
  launch_sums(keys.contiguous(), values.contiguous(), position.contiguous(), index.contiguous(),
              sum1, sum2, 0);
  return {sum1, sum2};
}

std::tuple<at::Tensor, at::Tensor, at::Tensor> neighbour_sums_backward_cuda(
    const at::Tensor& grad1_any, const at::Tensor& grad2_any, const at::Tensor& keys_any,
    const at::Tensor& values_any, const at::Tensor& position_any, const at::Tensor& index_any) {
  check_neighbour_sums_backward_args(grad1_any, grad2_any, keys_any, values_any, position_any,
                                     index_any);
  const c10::cuda::CUDAGuard guard(keys_any.device());
  const at::Tensor grad1 = grad1_any.contiguous(), grad2 = grad2_any.contiguous(),
                   keys = keys_any.contiguous(), values = values_any.contiguous(),
                   position = position_any.contiguous(), index = index_any.contiguous();
  const int64_t L = keys.size(0), m = keys.size(1), C = keys.size(2), Q = index.size(0),
                K = index.size(1);
  at::Tensor grad_keys = at::empty_like(keys), grad_values = at::empty_like(values),
             grad_position = at::zeros_like(position);
  if (L * m * C == 0) return {grad_keys, grad_values, grad_position};
  const auto [sorted, order] = at::sort(index.reshape({-1}), /*stable=*/true, 0, false);
  const at::Tensor begin = at::searchsorted(sorted, at::arange(m + 1, index.options()));
  const auto stream = c10::cuda::getCurrentCUDAStream();
  AT_DISPATCH_FLOATING_TYPES(keys.scalar_type(), "neighbour_sums_backward", [&] {
    if (Q * K * C > 0) {
      position_gradient_kernel<scalar_t><<<blocks_for(Q * K * C), kThreads, 0, stream>>>(
          grad1.const_data_ptr<scalar_t>(), grad2.const_data_ptr<scalar_t>(),
          keys.const_data_ptr<scalar_t>(), values.const_data_ptr<scalar_t>(),
          position.const_data_ptr<scalar_t>(), index.const_data_ptr<int64_t>(),
          grad_position.data_ptr<scalar_t>(), L, m, Q, K, C);
      C10_CUDA_KERNEL_LAUNCH_CHECK();
    }
    table_gradient_kernel<scalar_t><<<blocks_for(L * m * C), kThreads, 0, stream>>>(
        grad1.const_data_ptr<scalar_t>(), grad2.const_data_ptr<scalar_t>(),
        keys.const_data_ptr<scalar_t>(), values.const_data_ptr<scalar_t>(),
        position.const_data_ptr<scalar_t>(), order.const_data_ptr<int64_t>(),
        begin.const_data_ptr<int64_t>(), grad_keys.data_ptr<scalar_t>(),
        grad_values.data_ptr<scalar_t>(), L, m, Q, K, C);
    C10_CUDA_KERNEL_LAUNCH_CHECK();
  });
  return {grad_keys, grad_values, grad_position};
}

/// [2, L, m, C]: keys, then values.
at::Tensor neighbour_table_cuda(const at::Tensor& keys, const at::Tensor& values) {
  check_neighbour_table_args(keys, values);
  return at::stack({keys, values});
}

std::tuple<at::Tensor, at::Tensor> neighbour_sums_inference_cuda(const at::Tensor& table,
                                                                 const at::Tensor& hidden,
                                                                 const at::Tensor& weight,
                                                                 const at::Tensor& bias,
                                                                 const at::Tensor& index) {
  check_neighbour_sums_inference_args(table, hidden, weight, bias, index);
  const c10::cuda::CUDAGuard guard(table.device());
  const at::Tensor keys = table.select(0, 0), values = table.select(0, 1);
  const int64_t Q = index.size(0);
  at::Tensor sum1 = at::empty({keys.size(0), Q, keys.size(2)}, keys.options());
  at::Tensor sum2 = at::empty_like(sum1);
  for (int64_t first = 0; first < Q; first += kInferenceBlock) {
    const int64_t count = std::min(kInferenceBlock, Q - first);
    const at::Tensor position =
        at::linear(hidden.narrow(0, first, count), weight, bias).contiguous();
    launch_sums(keys, values, position, index.narrow(0, first, count).contiguous(), sum1, sum2,
                first);
  }
  return {sum1, sum2};
}

}  // namespace

TORCH_LIBRARY_IMPL(lte, CUDA, m) {
  m.impl("neighbour_sums", neighbour_sums_cuda);
  m.impl("neighbour_sums_backward", neighbour_sums_backward_cuda);
  m.impl("neighbour_table", neighbour_table_cuda);
  m.impl("neighbour_sums_inference", neighbour_sums_inference_cuda);
}

}  // namespace lte::ops
