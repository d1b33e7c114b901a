// CUDA twin of query_decoder_inference: one kernel from offsets to the sums over neighbours, then
// the layers as matrix products over blocks of queries.
//
// The kernel gives a block of threads one query and each thread one channel. γ's hidden activations
// of 32 neighbours lie in shared memory, a channel's P of the same in registers, so nothing of
// [queries, K, .] but the indices is ever in global memory.
#include <algorithm>
#include <cstdint>

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

#include "lte/ops/arguments.h"
#include "lte/ops/linear.h"

namespace lte::ops {
namespace {

constexpr int kNeighbours = 32;    ///< whose P a thread holds
constexpr int kHidden = 64;        ///< γ's activations of a neighbour in shared memory at a time
constexpr int kMaxThreads = 256;   ///< channels of a block; further ones are other blocks'
constexpr int64_t kBlock = 16384;  ///< queries whose sums exist, 100 MB at C = 128 and L = 6
/// Tensors before the layers, of a layer, and in all but the layers, as the header lists them.
constexpr size_t kFirstLayer = 8, kLayerWeights = 12, kFixedWeights = 14;

struct SumsArguments {
  const float* position;     ///< [Q, 3]
  const float* anchor;       ///< [m, 3]
  const int64_t* index;      ///< [Q, K]
  const float* hidden;       ///< [H, 3], γ's first layer
  const float* hidden_bias;  ///< [H]
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

/// Blocks: (query, run of channels). At least 32 threads. Every thread comes to every barrier,
/// whether it has a channel or not.
__global__ void __launch_bounds__(kMaxThreads) query_sums_kernel(const SumsArguments a) {
  __shared__ float offset[3][kNeighbours];
  __shared__ int64_t latent[kNeighbours];
  __shared__ __align__(16) float hidden[kHidden][kNeighbours];
  const int64_t q = blockIdx.x;
  const int thread = static_cast<int>(threadIdx.x), threads = static_cast<int>(blockDim.x);
  const int c = static_cast<int>(blockIdx.y) * threads + thread;
  const bool active = c < a.C;
  for (int first = 0; first < a.K; first += kNeighbours) {
    const int count = min(kNeighbours, a.K - first);
    __syncthreads();  // the neighbours before are no longer read
    if (thread < kNeighbours) {
      const bool real = thread < count;  // others are computed on and never added
      latent[thread] = real ? a.index[q * a.K + first + thread] : 0;
      for (int axis = 0; axis < 3; ++axis) {
        const float there = real ? a.anchor[3 * latent[thread] + axis] : 0;
        const float o = (a.position[3 * q + axis] - there) * a.scale;
        offset[axis][thread] = real ? fminf(fmaxf(o, -a.limit), a.limit) : 0;
      }
    }
    float P[kNeighbours];
#pragma unroll
    for (int k = 0; k < kNeighbours; ++k) P[k] = active ? a.output_bias[c] : 0;
    for (int h0 = 0; h0 < a.H; h0 += kHidden) {
      const int rows = min(kHidden, a.H - h0);
      __syncthreads();  // offsets are there, and the activations before no longer read
      for (int i = thread; i < rows * kNeighbours; i += threads) {
        const int h = i / kNeighbours, k = i % kNeighbours;
        const float* w = a.hidden + 3 * (h0 + h);
        const float x = w[0] * offset[0][k] + w[1] * offset[1][k] + w[2] * offset[2][k];
        const float active_value = gelu(x + a.hidden_bias[h0 + h]);
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

void check(const at::Tensor& t, at::IntArrayRef shape, const at::Tensor& table, const char* name) {
  TORCH_CHECK(t.sizes() == shape && t.scalar_type() == at::kFloat && t.device() == table.device(),
              "query_decoder_inference: ", name, " must be ", shape, " float32 on ", table.device(),
              ", got ", t.sizes(), " ", t.scalar_type(), " on ", t.device());
}

/// What the kernel reads; ATen checks what its own operators read. Indices are not looked at: the
/// host would wait for them.
void check_arguments(const at::Tensor& attributes, const at::Tensor& position,
                     const at::Tensor& anchor, const at::Tensor& index, const at::Tensor& table,
                     at::TensorList w) {
  const char* op = "query_decoder_inference";
  TORCH_CHECK(table.dim() == 4 && table.size(0) == 2 && table.scalar_type() == at::kFloat &&
                  table.is_contiguous() && anchor.dim() == 2 && table.size(2) == anchor.size(0),
              op, ": table must come from neighbour_table() for the anchors in float32, got ",
              table.sizes(), " ", table.scalar_type(), " and ", anchor.sizes(), " anchors");
  const int64_t Q = attributes.size(0), m = table.size(2), C = table.size(3);
  const size_t expected = kFixedWeights + static_cast<size_t>(table.size(1)) * kLayerWeights;
  TORCH_CHECK(w.size() == expected, op, ": ", table.size(1), " layers have ", expected,
              " weights, got ", w.size());
  check(position, {Q, 3}, table, "position");
  check(anchor, {m, 3}, table, "anchor");
  TORCH_CHECK(index.dim() == 2 && index.size(0) == Q && index.scalar_type() == at::kLong &&
                  index.device() == table.device() && index.size(1) >= 1,
              op, ": index must be [", Q, ", K] int64 on ", table.device(), ", got ", index.sizes(),
              " ", index.scalar_type(), " on ", index.device());
  TORCH_CHECK(w[4].dim() == 2 && w[4].size(0) >= 1, op, ": gamma.hidden must be [H, 3], got ",
              w[4].sizes());
  const int64_t H = w[4].size(0);
  check(w[4], {H, 3}, table, "gamma.hidden");
  check(w[5], {H}, table, "gamma.hidden's bias");
  const bool rounded = w[6].scalar_type() == at::kBFloat16;
  check(rounded ? w[6].to(at::kFloat) : w[6], {C, H}, table, "gamma.output");
  check(w[7], {C}, table, "gamma.output's bias");
}

void launch_sums(const SumsArguments& a) {
  const int threads = std::min(kMaxThreads, (a.C + 31) / 32 * 32);
  const dim3 blocks(static_cast<unsigned>(a.Q),
                    static_cast<unsigned>((a.C + threads - 1) / threads));
  query_sums_kernel<<<blocks, threads, 0, c10::cuda::getCurrentCUDAStream()>>>(a);
  C10_CUDA_KERNEL_LAUNCH_CHECK();
}

at::Tensor dense(const at::Tensor& x, at::TensorList w, size_t at) {
  return ops::linear(x, w[at], w[at + 1]);  // of bfloat16 weights too
}

at::Tensor perceptron(const at::Tensor& x, at::TensorList w, size_t at) {
  at::Tensor hidden = dense(x, w, at);
  return dense(at::gelu_(hidden), w, at + 2);
}

at::Tensor norm(const at::Tensor& x, at::TensorList w, size_t at) {
  return at::layer_norm(x, {x.size(1)}, w[at], w[at + 1]);
}

/// All layers and the head. @param sums  [2, L, Q, C]
at::Tensor run_layers(const at::Tensor& attributes, const at::Tensor& sums, int64_t K,
                      at::TensorList w) {
  at::Tensor G = perceptron(attributes, w, 0);
  size_t at = kFirstLayer;
  for (int64_t l = 0; l < sums.size(1); ++l, at += kLayerWeights) {
    const at::Tensor query = dense(norm(G, w, at), w, at + 2);
    at::Tensor attended = at::addcmul(sums[1][l], query, sums[0][l]);
    G.add_(dense(attended.mul_(1 / static_cast<double>(K)), w, at + 4));
    G.add_(perceptron(norm(G, w, at + 6), w, at + 8));
  }
  return at::softplus(perceptron(norm(G, w, at), w, at + 2));
}

at::Tensor query_decoder_inference_cuda(const at::Tensor& attributes,
                                        const at::Tensor& any_position,
                                        const at::Tensor& any_anchor, const at::Tensor& any_index,
                                        double scale, double limit, const at::Tensor& table,
                                        at::TensorList w) {
  TORCH_CHECK(attributes.dim() == 2, "query_decoder_inference: attributes must be [Q, A], got ",
              attributes.sizes());
  check_arguments(attributes, any_position, any_anchor, any_index, table, w);
  const c10::cuda::CUDAGuard guard(table.device());
  const at::NoGradGuard no_grad;
  const at::Tensor position = any_position.contiguous(), anchor = any_anchor.contiguous(),
                   index = any_index.contiguous(), gamma_hidden = w[4].contiguous(),
                   gamma_hidden_bias = w[5].contiguous(),
                   gamma_output = w[6].to(at::kFloat).t().contiguous(),
                   gamma_bias = w[7].contiguous();
  const int64_t Q = attributes.size(0), L = table.size(1), m = table.size(2), C = table.size(3),
                K = index.size(1), H = gamma_hidden.size(0);
  at::Tensor out = at::empty({Q, w.back().size(0)}, attributes.options());
  for (int64_t first = 0; first < Q; first += kBlock) {
    const int64_t count = std::min(kBlock, Q - first);
    at::Tensor sums = at::empty({2, L, count, C}, table.options());
    if (sums.numel() > 0) {
      launch_sums({position.const_data_ptr<float>() + 3 * first, anchor.const_data_ptr<float>(),
                   index.const_data_ptr<int64_t>() + K * first,
                   gamma_hidden.const_data_ptr<float>(), gamma_hidden_bias.const_data_ptr<float>(),
                   gamma_output.const_data_ptr<float>(), gamma_bias.const_data_ptr<float>(),
                   table.const_data_ptr<float>(), sums.data_ptr<float>(), m, count,
                   static_cast<int>(K), static_cast<int>(H), static_cast<int>(L),
                   static_cast<int>(C), static_cast<float>(scale), static_cast<float>(limit),
                   w[6].scalar_type() == at::kBFloat16});
    }
    out.narrow(0, first, count).copy_(run_layers(attributes.narrow(0, first, count), sums, K, w));
  }
  return out;
}

}  // namespace

TORCH_LIBRARY_IMPL(lte, CUDA, m) {
  m.impl("query_decoder_inference", query_decoder_inference_cuda);
}

}  // namespace lte::ops
