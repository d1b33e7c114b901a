// IEEE 754 binary16, for storage alone: 11 bits of precision, normal from 6.1e-5 to 65504.
#pragma once

#include <bit>
#include <cstdint>

namespace lte {

struct Half {
  uint16_t bits = 0;

  friend bool operator==(const Half&, const Half&) = default;
};

inline constexpr float kMaxHalf = 65504;

inline bool is_finite(Half value) { return (value.bits & 0x7c00) != 0x7c00; }

/// Rounds to the nearest, ties to even. From 65520 on, values become infinite.
inline Half to_half(float value) {
  const auto word = std::bit_cast<uint32_t>(value);
  const auto sign = static_cast<uint16_t>((word >> 16) & 0x8000);
  const uint32_t magnitude = word & 0x7fffffff;
  if (magnitude > 0x7f800000) return {static_cast<uint16_t>(sign | 0x7e00)};
  if (magnitude >= 0x477ff000) return {static_cast<uint16_t>(sign | 0x7c00)};
  if (magnitude < 0x38800000) {
    // Subnormal: adding 0.5 leaves a multiple of 2^-24 in the lowest bits, rounded by the adder.
    const float shifted = std::bit_cast<float>(magnitude) + 0.5f;
    return {static_cast<uint16_t>(sign | (std::bit_cast<uint32_t>(shifted) - 0x3f000000))};
  }
  const uint32_t odd = (magnitude >> 13) & 1;
  return {static_cast<uint16_t>(sign | ((magnitude - 0x38000000 + 0xfff + odd) >> 13))};
}

/// Exact.
inline float to_float(Half value) {
  const uint32_t sign = static_cast<uint32_t>(value.bits & 0x8000) << 16;
  const uint32_t magnitude = value.bits & 0x7fff;
  uint32_t word = (magnitude << 13) + 0x38000000;
  if (magnitude >= 0x7c00) word = 0x7f800000 | (magnitude & 0x3ff) << 13;
  // Not by way of a subnormal float, which some programs flush to zero.
  if (magnitude < 0x400) word = std::bit_cast<uint32_t>(static_cast<float>(magnitude) * 0x1p-24f);
  return std::bit_cast<float>(sign | word);
}

}  // namespace lte
