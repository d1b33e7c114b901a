// query_decoder_inference on CUDA: one kernel from offsets to the sums over neighbours, then
// the layers as matrix products over blocks of queries.
//
// The kernel gives a block of threads one query and each thread one channel. γ's hidden activations
// of 32 neighbours lie in shared memory, a channel's P of the same in registers, so nothing of
// [queries, K, .] but the indices is ever in global memory.
#include <algorithm>
#include <cstdint>
#include <optional>

#include <ATen/core/Tensor.h>
#include <ATen/core/grad_mode.h>
#include <ATen/ops/addcmul.h>
#include <ATen/ops/empty.h>
#include <ATen/ops/gelu.h>
#include <ATen/ops/layer_norm.h>
#include <ATen/ops/softplus.h>
#include <c10/cuda/CUDAException.h>
#include <c10/cuda/CUDAGuard.h>
#include <c10/cuda/CUDAStream.h>
#include <cuda_bf16.h>
#include <torch/library.h>

#include "lte/ops/linear.h"
#include "lte/ops/query_decoder_args.h"

namespace lte::ops {
namespace {

constexpr int kNeighbours = 32;    ///< neighbours whose P a thread holds
constexpr int kHidden = 64;        ///< γ's activations of a neighbour in shared memory at a time
constexpr int kMaxThreads = 256;   ///< channels of a block; further ones are other blocks'
constexpr int64_t kBlock = 16384;  ///< queries whose sums exist, 100 MB at C = 128 and L = 6

struct SumsArguments {
  const float* position;       ///< [Q, 3]
  const float* anchor;         ///< [m, 3]
  const int64_t* index;        ///< [Q, K]
  const float* normal;         ///< [Q, 3], or nullptr where γ reads the offset alone
  const float* anchor_normal;  ///< [m, 3], likewise
  const float* hidden;         ///< [H, F], γ's first layer
  const float* hidden_bias;    ///< [H]
  const float* output;       ///< [H, C], γ's second, transposed: threads read consecutive channels
  const float* output_bias;  ///< [C]
  const float* table;        ///< [2, L, m, C], keys, then values
  float* sums;               ///< [2, L, Q, C], S1, then S2
  int64_t m, Q;
  int K, H, L, C;
  float scale, limit;
  bool rounded;  ///< hidden activations are read as bfloat16, as `output` has been rounded
};

__device__ __forceinline__ float gelu(float x) {
  return 0.5f * x * (1 + erff(x * 0.70710678118654752f));
}

/// Adds neighbours [first, first + count) to the sums of query q and channel c.
__device__ __forceinline__ void add_sums(const SumsArguments& a, int64_t q, int c, bool from_zero,
                                         int count, const int64_t (&latent)[kNeighbours],
                                         const float (&P)[kNeighbours]) {
  const int64_t table_half = a.L * a.m * a.C, sums_half = a.L * a.Q * a.C;
  for (int l = 0; l < a.L; ++l) {
    const float* keys = a.table + l * a.m * a.C + c;
    const float* values = keys + table_half;
    float s1 = 0, s2 = 0;
#pragma unroll
    for (int k = 0; k < kNeighbours; ++k) {
      if (k < count) {
        const int64_t at = latent[k] * a.C;
        const float vp = values[at] + P[k];
        s1 += vp;
        s2 = fmaf(P[k] - keys[at], vp, s2);
      }
    }
    float* to = a.sums + (l * a.Q + q) * a.C + c;
    to[0] = from_zero ? s1 : to[0] + s1;
    to[sums_half] = from_zero ? s2 : to[sums_half] + s2;
  }
}

/// Column k of what γ reads of query q and a neighbour; zeros without one (`latent` < 0).
__device__ __forceinline__ void measure_pair(const SumsArguments& a, int64_t q, int64_t latent,
                                             int k, float (&geometry)[kNormalInputs][kNeighbours]) {
  float facing = 0, above = 0, ahead = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const float there = latent >= 0 ? a.anchor[3 * latent + axis] : 0;
    const float offset =
        latent >= 0 ? fminf(fmaxf((a.position[3 * q + axis] - there) * a.scale, -a.limit), a.limit)
                    : 0;
    geometry[axis][k] = offset;
    if (a.normal == nullptr || latent < 0) continue;
    const float here = a.normal[3 * q + axis], far = a.anchor_normal[3 * latent + axis];
    facing += here * far;
    above += here * offset;
    ahead += far * offset;
  }
  geometry[3][k] = facing;
  geometry[4][k] = above;
  geometry[5][k] = ahead;
}

/// Blocks: (query, run of channels). At least 32 threads. Every thread comes to every barrier,
/// whether it has a channel or not.
__global__ void __launch_bounds__(kMaxThreads) query_sums_kernel(const SumsArguments a) {
  __shared__ float geometry[kNormalInputs][kNeighbours];
  __shared__ int64_t latent[kNeighbours];
  __shared__ __align__(16) float hidden[kHidden][kNeighbours];
  const int64_t q = blockIdx.x;
  const int thread = static_cast<int>(threadIdx.x), threads = static_cast<int>(blockDim.x);
  const int c = static_cast<int>(blockIdx.y) * threads + thread;
  const bool active = c < a.C;
  const int inputs = a.normal != nullptr ? kNormalInputs : kOffsetInputs;
  for (int first = 0; first < a.K; first += kNeighbours) {
    const int count = min(kNeighbours, a.K - first);
    __syncthreads();  // the neighbours before are no longer read
    if (thread < kNeighbours) {
      const bool real = thread < count;  // others are computed on and never added
      latent[thread] = real ? a.index[q * a.K + first + thread] : 0;
      CUDA_KERNEL_ASSERT(latent[thread] >= 0 && latent[thread] < a.m &&
                         "a neighbour outside the latents");
      measure_pair(a, q, real ? latent[thread] : -1, thread, geometry);
    }
    float P[kNeighbours];
#pragma unroll
    for (int k = 0; k < kNeighbours; ++k) P[k] = active ? a.output_bias[c] : 0;
    for (int h0 = 0; h0 < a.H; h0 += kHidden) {
      const int rows = min(kHidden, a.H - h0);
      __syncthreads();  // the geometry is there, and the activations before no longer read
      for (int i = thread; i < rows * kNeighbours; i += threads) {
        const int h = i / kNeighbours, k = i % kNeighbours;
        const float* w = a.hidden + inputs * (h0 + h);
        float x = a.hidden_bias[h0 + h];
        for (int f = 0; f < inputs; ++f) x = fmaf(w[f], geometry[f][k], x);
        const float active_value = gelu(x);
        hidden[h][k] =
            a.rounded ? __bfloat162float(__float2bfloat16_rn(active_value)) : active_value;
      }
      __syncthreads();
      if (!active) continue;
      for (int h = 0; h < rows; ++h) {
        const float w = a.output[static_cast<int64_t>(h0 + h) * a.C + c];
        const auto* of_neighbours = reinterpret_cast<const float4*>(hidden[h]);
#pragma unroll
        for (int v = 0; v < kNeighbours / 4; ++v) {
          const float4 x = of_neighbours[v];
          P[4 * v] = fmaf(w, x.x, P[4 * v]);
          P[4 * v + 1] = fmaf(w, x.y, P[4 * v + 1]);
          P[4 * v + 2] = fmaf(w, x.z, P[4 * v + 2]);
          P[4 * v + 3] = fmaf(w, x.w, P[4 * v + 3]);
        }
      }
    }
    if (active) add_sums(a, q, c, first == 0, count, latent, P);
  }
}

void launch_sums(const SumsArguments& a) {
  const int threads = std::min(kMaxThreads, (a.C + 31) / 32 * 32);
  const dim3 blocks(static_cast<unsigned>(a.Q),
                    static_cast<unsigned>((a.C + threads - 1) / threads));
  query_sums_kernel<<<blocks, threads, 0, c10::cuda::getCurrentCUDAStream()>>>(a);
  C10_CUDA_KERNEL_LAUNCH_CHECK();
}

at::Tensor dense(const at::Tensor& x, const LinearWeights& w) {
  return ops::linear(x, w.weight, w.bias);  // takes bfloat16 weights too
}

at::Tensor perceptron(const at::Tensor& x, const PerceptronWeights& w) {
  at::Tensor hidden = dense(x, w.hidden);
  return dense(at::gelu_(hidden), w.output);
}

at::Tensor norm(const at::Tensor& x, const NormWeights& w) {
  return at::layer_norm(x, {x.size(1)}, w.gain, w.bias);
}

/// All layers and the head. @param sums  [2, L, Q, C]
at::Tensor run_layers(const at::Tensor& attributes, const at::Tensor& sums, int64_t K,
                      const DecoderWeights& w) {
  at::Tensor G = perceptron(attributes, w.point);
  const at::Tensor S1 = sums[0], S2 = sums[1];
  for (int64_t l = 0; l < sums.size(1); ++l) {
    const LayerWeights& layer = w.layers[l];
    const at::Tensor query = dense(norm(G, layer.norm1), layer.query);
    at::Tensor attended = at::addcmul(S2[l], query, S1[l]);
    G.add_(dense(attended.mul_(1 / static_cast<double>(K)), layer.output));
    G.add_(perceptron(norm(G, layer.norm2), layer.ffn));
  }
  return at::softplus(perceptron(norm(G, w.norm), w.head));
}

at::Tensor query_decoder_inference_cuda(const at::Tensor& attributes,
                                        const at::Tensor& any_position,
                                        const at::Tensor& any_anchor, const at::Tensor& any_index,
                                        double scale, double limit,
                                        const std::optional<at::Tensor>& any_normal,
                                        const std::optional<at::Tensor>& any_anchor_normal,
                                        const at::Tensor& table, at::TensorList list) {
  const DecoderWeights w = DecoderWeights::from_list(list, table_layers(table));
  const at::Tensor normal = any_normal.has_value() ? any_normal->contiguous() : at::Tensor(),
                   anchor_normal = any_anchor_normal.has_value() ? any_anchor_normal->contiguous()
                                                                 : at::Tensor();
  const DecoderSizes sizes = check_query_decoder_args(
      attributes, {any_position, any_anchor, any_index, scale, limit, normal, anchor_normal}, table,
      w);
  const c10::cuda::CUDAGuard guard(table.device());
  const at::NoGradGuard no_grad;
  const at::Tensor position = any_position.contiguous(), anchor = any_anchor.contiguous(),
                   index = any_index.contiguous(),
                   gamma_hidden = w.gamma.hidden.weight.contiguous(),
                   gamma_hidden_bias = w.gamma.hidden.bias.contiguous(),
                   gamma_output = w.gamma.output.weight.to(at::kFloat).t().contiguous(),
                   gamma_bias = w.gamma.output.bias.contiguous();
  SumsArguments arguments{};
  if (normal.defined()) arguments.anchor_normal = anchor_normal.const_data_ptr<float>();
  arguments.anchor = anchor.const_data_ptr<float>();
  arguments.hidden = gamma_hidden.const_data_ptr<float>();
  arguments.hidden_bias = gamma_hidden_bias.const_data_ptr<float>();
  arguments.output = gamma_output.const_data_ptr<float>();
  arguments.output_bias = gamma_bias.const_data_ptr<float>();
  arguments.table = table.const_data_ptr<float>();
  arguments.m = sizes.latents;
  arguments.K = static_cast<int>(sizes.neighbours);
  arguments.H = static_cast<int>(sizes.gamma_hidden);
  arguments.L = static_cast<int>(sizes.layers);
  arguments.C = static_cast<int>(sizes.channels);
  arguments.scale = static_cast<float>(scale);
  arguments.limit = static_cast<float>(limit);
  arguments.rounded = w.gamma.output.weight.scalar_type() == at::kBFloat16;
  at::Tensor out = at::empty({sizes.queries, sizes.outputs}, attributes.options());
  for (int64_t first = 0; first < sizes.queries; first += kBlock) {
    const int64_t count = std::min(kBlock, sizes.queries - first);
    at::Tensor sums = at::empty({2, sizes.layers, count, sizes.channels}, table.options());
    arguments.position = position.const_data_ptr<float>() + 3 * first;
    if (normal.defined()) arguments.normal = normal.const_data_ptr<float>() + 3 * first;
    arguments.index = index.const_data_ptr<int64_t>() + sizes.neighbours * first;
    arguments.sums = sums.data_ptr<float>();
    arguments.Q = count;
    if (sums.numel() > 0) launch_sums(arguments);
    out.narrow(0, first, count)
        .copy_(run_layers(attributes.narrow(0, first, count), sums, sizes.neighbours, w));
  }
  return out;
}

}  // namespace

TORCH_LIBRARY_IMPL(lte, CUDA, m) {
  m.impl("query_decoder_inference", query_decoder_inference_cuda);
}

}  // namespace lte::ops
