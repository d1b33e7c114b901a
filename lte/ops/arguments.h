// Argument checks that the twins of several operators share.
#pragma once

#include <cmath>
#include <cstdint>

#include <ATen/Parallel.h>
#include <ATen/core/Tensor.h>
#include <c10/util/Exception.h>

namespace lte::ops {

/// Rows of an elementwise pass that one thread takes at least.
inline constexpr int64_t kGrain = 4096;

/// The lowest row in [0, rows) for which `bad(row)` holds, or `rows`.
template <typename Predicate>
int64_t first_row(int64_t rows, const Predicate& bad) {
  return at::parallel_reduce(
      int64_t{0}, rows, kGrain, rows,
      [&](int64_t begin, int64_t end, int64_t none) {
        for (int64_t row = begin; row < end; ++row) {
          if (bad(row)) return row;
        }
        return none;
      },
      [](int64_t a, int64_t b) { return a < b ? a : b; });
}

/// [N, 3], of one dtype, dense rows; N below 2^31 as the kernels index with 32 bits.
inline void check_triples(const at::Tensor& t, at::ScalarType dtype, const char* op,
                          const char* name) {
  TORCH_CHECK(t.dim() == 2 && t.size(1) == 3, op, ": ", name, " must be [N, 3], got ", t.sizes());
  TORCH_CHECK(t.scalar_type() == dtype, op, ": ", name, " must be ", c10::toString(dtype), ", got ",
              c10::toString(t.scalar_type()));
  TORCH_CHECK(t.is_contiguous(), op, ": ", name, " must be contiguous");
  TORCH_CHECK(t.size(0) < (int64_t{1} << 31), op, ": ", name,
              " has 2^31 rows or more: ", t.size(0));
}

/// [Q, K] int64 on the CPU, entries in [0, m).
inline void check_neighbours(const at::Tensor& index, int64_t Q, int64_t m, const char* op) {
  TORCH_CHECK(index.dim() == 2 && index.size(0) == Q && index.scalar_type() == at::kLong, op,
              ": index must be [Q, K] int64, got ", index.sizes(), " ", index.scalar_type());
  TORCH_CHECK(index.numel() < (int64_t{1} << 31), op,
              ": index has 2^31 entries or more: ", index.numel());
  const auto* latent = index.const_data_ptr<int64_t>();
  const int64_t K = index.size(1) > 0 ? index.size(1) : 1;
  const int64_t bad =
      first_row(index.numel(), [&](int64_t i) { return latent[i] < 0 || latent[i] >= m; });
  TORCH_CHECK(bad == index.numel(), op, ": index of query ", bad / K, ", neighbour ", bad % K,
              " is ", latent[bad], ", outside the ", m, " latents");
}

/// CPU tensors only.
inline void check_finite_rows(const at::Tensor& t, const char* op, const char* name) {
  const auto* p = t.const_data_ptr<float>();
  const int64_t row = first_row(t.size(0), [&](int64_t i) {
    return !(std::isfinite(p[3 * i]) && std::isfinite(p[3 * i + 1]) && std::isfinite(p[3 * i + 2]));
  });
  TORCH_CHECK(row == t.size(0), op, ": row ", row, " of ", name, " is not finite: (", p[3 * row],
              ", ", p[3 * row + 1], ", ", p[3 * row + 2], ")");
}

}  // namespace lte::ops
