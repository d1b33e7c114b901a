#include "lte/image/srgb_byte.h"

#include <cmath>

#include "lte/base/srgb.h"

namespace lte::image {
namespace {

uint8_t byte_of(uint32_t bits) {
  return static_cast<uint8_t>(std::lround(255 * linear_to_srgb(std::bit_cast<float>(bits))));
}

}  // namespace

SrgbBytes::SrgbBytes() {
  for (uint32_t byte = 1; byte < 256; ++byte) {
    uint32_t below = 0, reached = kOne;
    while (reached - below > 1) {
      const uint32_t middle = below + (reached - below) / 2;
      (byte_of(middle) >= byte ? reached : below) = middle;
    }
    threshold_[byte] = reached;
  }
  threshold_[256] = kOne;
  for (uint32_t bin = 0; bin < lowest_.size(); ++bin) lowest_[bin] = byte_of(bin << kShift);
}

const SrgbBytes& srgb_bytes() {
  static const SrgbBytes bytes;
  return bytes;
}

}  // namespace lte::image
