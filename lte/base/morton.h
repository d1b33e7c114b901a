// An order of cells in which neighbours lie near each other.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace lte {

/// Place of a cell along Morton's curve (the Z curve): the bits of its coordinates in turn, the
/// first coordinate's lowest. Of coordinates below 2²¹.
constexpr uint64_t morton_code(const std::array<uint32_t, 3>& cell) {
  constexpr size_t kBits = 21;
  uint64_t code = 0;
  for (size_t axis = 0; axis < 3; ++axis) {
    for (size_t bit = 0; bit < kBits; ++bit)
      code |= ((uint64_t{cell[axis]} >> bit) & 1) << (3 * bit + axis);
  }
  return code;
}

}  // namespace lte
