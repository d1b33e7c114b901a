// What curve_codes() accepts, and the curve arithmetic that its kernels share.
#pragma once

#include <cstdint>

#include "lte/ops/arguments.h"
#include "lte/ops/curve_codes.h"
#include "lte/tensor/tensor.h"

namespace lte::ops {

inline void check_curve_codes_args(const at::Tensor& cells, int64_t curve, int64_t bits) {
  TORCH_CHECK(curve >= 0 && curve <= 3, "curve_codes: curve must be 0 (z), 1 (z transposed), ",
              "2 (hilbert) or 3 (hilbert transposed), got ", curve);
  TORCH_CHECK(bits >= 1 && bits <= 21, "curve_codes: bits must be 1 to 21, got ", bits);
  check_cells(cells, bits, "curve_codes");
}

/// Moves bit i of a 21-bit number to bit 3i.
C10_HOST_DEVICE inline int64_t spread_bits(int64_t v) {
  v = (v | v << 32) & 0x1f00000000ffff;
  v = (v | v << 16) & 0x1f0000ff0000ff;
  v = (v | v << 8) & 0x100f00f00f00f00f;
  v = (v | v << 4) & 0x10c30c30c30c30c3;
  v = (v | v << 2) & 0x1249249249249249;
  return v;
}

C10_HOST_DEVICE inline int64_t z_code(int32_t x, int32_t y, int32_t z) {
  return spread_bits(x) << 2 | spread_bits(y) << 1 | spread_bits(z);
}

/// Skilling: undo the excess rotations from the top bit down, then read the Gray word that remains.
C10_HOST_DEVICE inline int64_t hilbert_code(int32_t x, int32_t y, int32_t z, int bits) {
  int32_t axes[3] = {x, y, z};
  for (int bit = bits - 1; bit >= 0; --bit) {
    const int32_t low = (1 << bit) - 1;
    for (int32_t& axis : axes) {
      if (axis >> bit & 1) {
        axes[0] ^= low;
      } else {
        const int32_t swap = (axes[0] ^ axis) & low;
        axes[0] ^= swap;
        axis ^= swap;
      }
    }
  }
  int64_t code = z_code(axes[0], axes[1], axes[2]);
  for (int shift = 1; shift < 64; shift *= 2) code ^= code >> shift;  // Gray to binary
  return code;
}

C10_HOST_DEVICE inline int64_t curve_code(const int32_t* cell, Curve curve, int bits) {
  const bool transposed = curve == Curve::ZTransposed || curve == Curve::HilbertTransposed;
  const int32_t x = cell[transposed ? 1 : 0], y = cell[transposed ? 0 : 1], z = cell[2];
  const bool hilbert = curve == Curve::Hilbert || curve == Curve::HilbertTransposed;
  return hilbert ? hilbert_code(x, y, z, bits) : z_code(x, y, z);
}

}  // namespace lte::ops
