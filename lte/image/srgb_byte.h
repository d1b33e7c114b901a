// The sRGB curve to 8 bits, by a table: its power is costly.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace lte::image {

/// The byte of every float in (0, 1). Floats are ordered as their bits are: those that share their
/// upper bits have the byte of the first of them, or of one of the next thresholds.
class SrgbBytes {
 public:
  SrgbBytes();

  /// round(255 * linear_to_srgb(linear)), to the bit. NaN is 0.
  uint8_t operator()(float linear) const {
    if (!(linear > 0)) return 0;
    if (linear >= 1) return 255;
    const auto bits = std::bit_cast<uint32_t>(linear);
    size_t byte = lowest_[bits >> kShift];
    while (bits >= threshold_[byte + 1]) ++byte;
    return static_cast<uint8_t>(byte);
  }

 private:
  static constexpr int kShift = 16;
  static constexpr uint32_t kOne = 0x3f800000;  ///< the bits of 1

  std::array<uint32_t, 257> threshold_{};  ///< bits of the smallest float with each byte
  std::array<uint8_t, (kOne >> kShift)> lowest_{};
};

/// Made when it is first asked for.
const SrgbBytes& srgb_bytes();

}  // namespace lte::image
