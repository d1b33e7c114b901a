// Neighbour sums on the CPU: interleaving of the tables, tiles of queries for the kernels, and
// their gradients.
#include <algorithm>
#include <cstring>
#include <vector>

#include "lte/ops/cpu/dense/packed_linear.h"
#include "lte/ops/cpu/kernels/kernels.h"
#include "lte/ops/cpu/neighbours/pairs_by_latent.h"
#include "lte/ops/neighbour_sums_args.h"
#include "lte/tensor/functions.h"
#include "lte/tensor/library.h"

namespace lte::ops {
namespace {

/// Queries of a tile: their positions, 256 KiB at 32 neighbours and 128 channels, stay in the
/// second-level cache.
constexpr int64_t kTile = 16;
constexpr int64_t kPair = 2 * kBlock;
static_assert(kTableBlock == kBlock);

/// A row of two [L, n, C] tensors as [blocks, L, 2, kBlock].
template <typename T>
void interleave(const T* first, const T* second, int64_t L, int64_t n, int64_t C, int64_t row,
                T* out) {
  for (int64_t c = 0; c < C; c += kBlock) {
    const int64_t count = std::min(kBlock, C - c);
    for (int64_t l = 0; l < L; ++l, out += kPair) {
      const int64_t from = (l * n + row) * C + c;
      std::copy_n(first + from, count, out);
      std::fill(out + count, out + kBlock, T{0});
      std::copy_n(second + from, count, out + kBlock);
      std::fill(out + kBlock + count, out + kPair, T{0});
    }
  }
}

template <typename T>
void deinterleave(const T* in, int64_t L, int64_t n, int64_t C, int64_t begin, int64_t end,
                  T* first, T* second) {
  for (int64_t row = begin; row < end; ++row) {
    for (int64_t c = 0; c < C; c += kBlock) {
      const int64_t count = std::min(kBlock, C - c);
      for (int64_t l = 0; l < L; ++l, in += kPair) {
        const int64_t to = (l * n + row) * C + c;
        std::copy_n(in, count, first + to);
        std::copy_n(in + kBlock, count, second + to);
      }
    }
  }
}

/// As [n, blocks, L, 2, kBlock] with `gap` numbers after each row.
at::Tensor interleaved(const at::Tensor& first, const at::Tensor& second, int64_t gap = 0) {
  const int64_t L = first.size(0), n = first.size(1), C = first.size(2);
  const int64_t stride = blocks_of(C) * L * kPair + gap;
  at::Tensor out = at::empty_strided({n, blocks_of(C), L, 2, kBlock},
                                     {stride, L * kPair, kPair, kBlock, 1}, first.options());
  AT_DISPATCH_FLOATING_TYPES(first.scalar_type(), "neighbour_table", [&] {
    const auto* a = first.const_data_ptr<scalar_t>();
    const auto* b = second.const_data_ptr<scalar_t>();
    auto* to = out.data_ptr<scalar_t>();
    at::parallel_for(0, n, 64, [&](int64_t begin, int64_t end) {
      for (int64_t row = begin; row < end; ++row) interleave(a, b, L, n, C, row, to + row * stride);
    });
  });
  return out;
}

/// `position` with its channels padded to whole blocks; itself if they are.
at::Tensor padded(const at::Tensor& position) {
  const int64_t C = position.size(2), width = blocks_of(C) * kBlock;
  if (width == C) return position.contiguous();
  return at::constant_pad_nd(position, {0, width - C});
}

std::tuple<at::Tensor, at::Tensor> neighbour_sums_cpu(const at::Tensor& keys,
                                                      const at::Tensor& values,
                                                      const at::Tensor& position,
                                                      const at::Tensor& any_index) {
  check_neighbour_sums_args(keys, values, position, any_index);
  const at::Tensor index = any_index.contiguous();
  const int64_t L = keys.size(0), C = keys.size(2), Q = index.size(0), K = index.size(1);
  const int64_t blocks = blocks_of(C), width = blocks * kBlock;
  const at::Tensor table = interleaved(keys.contiguous(), values.contiguous());
  const at::Tensor p = padded(position);
  at::Tensor sum1 = at::empty({L, Q, C}, keys.options()), sum2 = at::empty_like(sum1);
  AT_DISPATCH_FLOATING_TYPES(keys.scalar_type(), "neighbour_sums", [&] {
    const auto* entries = table.const_data_ptr<scalar_t>();
    const auto* latent = index.const_data_ptr<int64_t>();
    const auto* from = p.const_data_ptr<scalar_t>();
    auto* out1 = sum1.data_ptr<scalar_t>();
    auto* out2 = sum2.data_ptr<scalar_t>();
    at::parallel_for(0, Q, kTile, [&](int64_t begin, int64_t end) {
      std::vector<scalar_t> tile(kTile * blocks * L * kPair);
      for (int64_t q = begin; q < end; q += kTile) {
        const int64_t count = std::min(kTile, end - q);
        sum_kernels<scalar_t>().sums(
            {entries, table.stride(0), blocks, L, latent + q * K, count, K},
            {from + q * K * width, width, kBlock}, tile.data());
        deinterleave(tile.data(), L, Q, C, q, q + count, out1, out2);
      }
    });
  });
  return {sum1, sum2};
}

std::tuple<at::Tensor, at::Tensor, at::Tensor> neighbour_sums_backward_cpu(
    const at::Tensor& grad1, const at::Tensor& grad2, const at::Tensor& keys,
    const at::Tensor& values, const at::Tensor& position, const at::Tensor& any_index) {
  check_neighbour_sums_backward_args(grad1, grad2, keys, values, position, any_index);
  const at::Tensor index = any_index.contiguous();
  const int64_t L = keys.size(0), m = keys.size(1), C = keys.size(2);
  const int64_t Q = index.size(0), K = index.size(1);
  const int64_t blocks = blocks_of(C), width = blocks * kBlock, entry = blocks * L * kPair;
  const at::Tensor table = interleaved(keys.contiguous(), values.contiguous());
  const at::Tensor grad = interleaved(grad1.contiguous(), grad2.contiguous());
  const at::Tensor p = padded(position);
  at::Tensor by_keys = at::empty({L, m, C}, keys.options()), by_values = at::empty_like(by_keys);
  at::Tensor by_position = at::empty({Q, K, width}, keys.options());
  AT_DISPATCH_FLOATING_TYPES(keys.scalar_type(), "neighbour_sums_backward", [&] {
    const SumKernels<scalar_t>& kernels = sum_kernels<scalar_t>();
    const auto* entries = table.const_data_ptr<scalar_t>();
    const auto* g = grad.const_data_ptr<scalar_t>();
    const auto* from = p.const_data_ptr<scalar_t>();
    const auto* latent = index.const_data_ptr<int64_t>();
    auto* to = by_position.data_ptr<scalar_t>();
    at::parallel_for(0, Q, kTile, [&](int64_t begin, int64_t end) {
      for (int64_t q = begin; q < end; q += kTile) {
        kernels.position_gradient(
            {entries, entry, blocks, L, latent + q * K, std::min(kTile, end - q), K}, g + q * entry,
            from + q * K * width, to + q * K * width);
      }
    });
    const PairsByLatent pairs(latent, Q * K, m);
    auto* to_keys = by_keys.data_ptr<scalar_t>();
    auto* to_values = by_values.data_ptr<scalar_t>();
    at::parallel_for(0, m, 16, [&](int64_t begin, int64_t end) {
      std::vector<scalar_t> gradient(entry);
      for (int64_t j = begin; j < end; ++j) {
        kernels.table_gradient(
            {entries + j * entry, g, blocks, L, pairs.rows.data() + pairs.start[j],
             pairs.start[j + 1] - pairs.start[j], K, from, false},
            gradient.data());
        deinterleave(gradient.data(), L, m, C, j, j + 1, to_keys, to_values);
      }
    });
  });
  return {by_keys, by_values, width == C ? by_position : by_position.narrow(2, 0, C).contiguous()};
}

at::Tensor neighbour_table_cpu(const at::Tensor& keys, const at::Tensor& values) {
  check_neighbour_table_args(keys, values);
  return interleaved(keys.contiguous(), values.contiguous(), kTableGap);
}

/// [K, H] as [H, rows], rows past K zero.
void transpose(const float* hidden, int64_t K, int64_t H, int64_t rows, float* out) {
  for (int64_t h = 0; h < H; ++h, out += rows) {
    for (int64_t i = 0; i < K; ++i) out[i] = hidden[i * H + h];
    std::fill(out + K, out + rows, 0.0f);
  }
}

std::tuple<at::Tensor, at::Tensor> neighbour_sums_inference_cpu(const at::Tensor& table,
                                                                const at::Tensor& any_hidden,
                                                                const at::Tensor& weight,
                                                                const at::Tensor& bias,
                                                                const at::Tensor& any_index) {
  const int64_t L =
      check_neighbour_sums_inference_args(table, any_hidden, weight, bias, any_index).layers;
  const at::Tensor index = any_index.contiguous(), hidden = any_hidden.contiguous();
  const int64_t blocks = table.size(1), C = weight.size(0), H = weight.size(1);
  const int64_t Q = index.size(0), K = index.size(1);
  const PackedLinear gamma(weight, bias);
  at::Tensor sum1 = at::empty({L, Q, C}, table.options()), sum2 = at::empty_like(sum1);
  const auto* entries = table.const_data_ptr<float>();
  const auto* activation = hidden.const_data_ptr<float>();
  const auto* latent = index.const_data_ptr<int64_t>();
  auto* out1 = sum1.data_ptr<float>();
  auto* out2 = sum2.data_ptr<float>();
  at::parallel_for(0, Q, kTile, [&](int64_t begin, int64_t end) {
    const SumKernels<float>& kernels = sum_kernels<float>();
    const int64_t rows = blocks_of(K) * kBlock;
    std::vector<float> transposed(kTile * H * rows),
        position(kProjectedQueries * kProjectedBlocks * rows * kBlock),
        tile(kTile * blocks * L * kPair);
    for (int64_t q = begin; q < end; q += kTile) {
      const int64_t count = std::min(kTile, end - q);
      for (int64_t i = 0; i < count; ++i) {
        transpose(activation + (q + i) * K * H, K, H, rows, transposed.data() + i * H * rows);
      }
      kernels.projected_sums(
          {entries, table.stride(0), blocks, L, latent + q * K, count, K},
          {transposed.data(), 0, H, gamma.weight.data(), gamma.bias.data(), position.data()},
          tile.data());
      deinterleave(tile.data(), L, Q, C, q, q + count, out1, out2);
    }
  });
  return {sum1, sum2};
}

}  // namespace
}  // namespace lte::ops

TORCH_LIBRARY_IMPL(lte, CPU, m) {
  m.impl("neighbour_sums", lte::ops::neighbour_sums_cpu);
  m.impl("neighbour_sums_backward", lte::ops::neighbour_sums_backward_cpu);
  m.impl("neighbour_table", lte::ops::neighbour_table_cpu);
  m.impl("neighbour_sums_inference", lte::ops::neighbour_sums_inference_cpu);
}
