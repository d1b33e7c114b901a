// Argument checks that several operators share. Each operator has one check of its own, in
// x_args.h, that all its kernels call.
//
// Shapes, types and devices are checked everywhere. What a tensor holds is checked on the CPU
// alone: for a look into the memory of a GPU the host would have to wait, so kernels assert it.
#pragma once

#include <cmath>
#include <cstdint>

#include "lte/tensor/tensor.h"

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

/// `t` has this shape and dtype.
inline void check_shape(const at::Tensor& t, at::IntArrayRef shape, at::ScalarType dtype,
                        const char* op, const char* name) {
  TORCH_CHECK(t.sizes() == shape && t.scalar_type() == dtype, op, ": ", name, " must be ", shape,
              " ", dtype, ", got ", t.sizes(), " ", t.scalar_type());
}

/// `t` is on the device of `first`.
inline void check_device(const at::Tensor& t, const char* name, const at::Tensor& first,
                         const char* first_name, const char* op) {
  TORCH_CHECK(t.device() == first.device(), op, ": ", first_name, " are on ", first.device(), ", ",
              name, " on ", t.device());
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

/// Cells [N, 3] int32, contiguous; on the CPU in [0, 2^bits).
inline void check_cells(const at::Tensor& cells, int64_t bits, const char* op) {
  check_triples(cells, at::kInt, op, "cells");
  if (!cells.is_cpu()) return;
  const auto* in = cells.const_data_ptr<int32_t>();
  const int64_t row = first_row(cells.size(0), [&](int64_t i) {
    return ((in[3 * i] | in[3 * i + 1] | in[3 * i + 2]) >> bits) != 0;
  });
  TORCH_CHECK(row == cells.size(0), op, ": row ", row, " of cells is outside [0, 2^", bits, "): (",
              in[3 * row], ", ", in[3 * row + 1], ", ", in[3 * row + 2], ")");
}

/// [Q, K] int64; on the CPU, entries in [0, m). Any strides.
inline void check_neighbours(const at::Tensor& index, int64_t Q, int64_t m, const char* op) {
  TORCH_CHECK(index.dim() == 2 && index.size(0) == Q && index.scalar_type() == at::kLong, op,
              ": index must be [Q, K] int64, got ", index.sizes(), " ", index.scalar_type());
  TORCH_CHECK(index.numel() < (int64_t{1} << 31), op,
              ": index has 2^31 entries or more: ", index.numel());
  if (!index.is_cpu()) return;
  const at::Tensor rows = index.contiguous();
  const auto* latent = rows.const_data_ptr<int64_t>();
  const int64_t K = index.size(1) > 0 ? index.size(1) : 1;
  const int64_t bad =
      first_row(index.numel(), [&](int64_t i) { return latent[i] < 0 || latent[i] >= m; });
  TORCH_CHECK(bad == index.numel(), op, ": index of query ", bad / K, ", neighbour ", bad % K,
              " is ", latent[bad], ", outside the ", m, " latents");
}

/// On the CPU, every number of `t` [N, 3] float32, contiguous, is finite.
inline void check_finite_rows(const at::Tensor& t, const char* op, const char* name) {
  if (!t.is_cpu()) return;
  const auto* p = t.const_data_ptr<float>();
  const int64_t row = first_row(t.size(0), [&](int64_t i) {
    return !(std::isfinite(p[3 * i]) && std::isfinite(p[3 * i + 1]) && std::isfinite(p[3 * i + 2]));
  });
  TORCH_CHECK(row == t.size(0), op, ": row ", row, " of ", name, " is not finite: (", p[3 * row],
              ", ", p[3 * row + 1], ", ", p[3 * row + 2], ")");
}

}  // namespace lte::ops
