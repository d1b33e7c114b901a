// Codes along space-filling curves, as many cells at once as there are lanes: the arithmetic
// of curve_codes_kernel.h without its branches.
#include <cstddef>

#include "lte/ops/cpu/kernels/kernels.h"
#include "lte/ops/cpu/kernels/vector.h"

namespace lte::ops::LTE_ISA {
namespace {

using Bits = Vector<uint32_t>;
using Wide = Vector<uint64_t>;
constexpr int kCells = kLanes<uint32_t>, kWide = kLanes<uint64_t>;

/// A coordinate of kCells cells.
struct Cells {
  Bits axis[3];
};

/// Skilling's rotations from the top bit down; the Gray word remains.
void rotate(Cells& cells, int bits) {
  const Bits one = splat(uint32_t{1});
  for (int bit = bits - 1; bit >= 0; --bit) {
    const Bits low = splat((uint32_t{1} << bit) - 1);
    for (Bits& axis : cells.axis) {
      const Bits set = Bits{} - (axis >> static_cast<uint32_t>(bit) & one);
      const Bits swap = (cells.axis[0] ^ axis) & low & ~set;
      cells.axis[0] ^= swap | (low & set);
      axis ^= swap;
    }
  }
}

/// Bit i of 21 to bit 3i.
Wide spread(Wide v) {
  v = (v | v << 32) & splat(uint64_t{0x1f00000000ffff});
  v = (v | v << 16) & splat(uint64_t{0x1f0000ff0000ff});
  v = (v | v << 8) & splat(uint64_t{0x100f00f00f00f00f});
  v = (v | v << 4) & splat(uint64_t{0x10c30c30c30c30c3});
  v = (v | v << 2) & splat(uint64_t{0x1249249249249249});
  return v;
}

/// kWide of the cells from lane `first` on.
Wide widen(const Bits& v, int first) {
  typedef uint32_t Half __attribute__((vector_size(kVectorBytes / 2)));
  Half half;
  __builtin_memcpy(&half, reinterpret_cast<const uint32_t*>(&v) + first, sizeof half);
  return __builtin_convertvector(half, Wide);
}

void codes(Cells cells, bool hilbert, int bits, int64_t* out) {
  if (hilbert) rotate(cells, bits);
  for (int first = 0; first < kCells; first += kWide) {
    Wide code = spread(widen(cells.axis[0], first)) << 2 |
                spread(widen(cells.axis[1], first)) << 1 | spread(widen(cells.axis[2], first));
    if (hilbert) {
      for (uint64_t shift = 1; shift < 64; shift *= 2) code ^= code >> shift;  // Gray to binary
    }
    __builtin_memcpy(out + first, &code, sizeof code);
  }
}

void curve_codes(const int32_t* cells, int64_t count, bool hilbert, bool transposed, int bits,
                 int64_t* out) {
  const int x = transposed ? 1 : 0, y = transposed ? 0 : 1;
  for (int64_t i = 0; i < count; i += kCells) {
    const int64_t here = count - i < kCells ? count - i : kCells;
    Cells block = {};
    for (int64_t lane = 0; lane < here; ++lane) {
      const int32_t* cell = cells + 3 * (i + lane);
      block.axis[0][lane] = static_cast<uint32_t>(cell[x]);
      block.axis[1][lane] = static_cast<uint32_t>(cell[y]);
      block.axis[2][lane] = static_cast<uint32_t>(cell[2]);
    }
    int64_t code[kCells];
    codes(block, hilbert, bits, code);
    __builtin_memcpy(out + i, code, static_cast<size_t>(here) * sizeof(int64_t));
  }
}

}  // namespace

extern const CurveKernels kCurveKernels;
const CurveKernels kCurveKernels{curve_codes};

}  // namespace lte::ops::LTE_ISA
