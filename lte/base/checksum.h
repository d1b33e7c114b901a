// A hash that tells a file as it was written from the same file with damaged bytes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace lte {

/// 64 bits of everything that is added, in its order and cut as it is added. Four lanes of 64-bit
/// words, so that it runs at the speed of memory. Not cryptographic: it is for disks and cables,
/// not for adversaries.
class Checksum {
 public:
  void add(const void* bytes, size_t size);
  void add(std::string_view text) { add(text.data(), text.size()); }

  uint64_t value() const;
  /// value() in decimal.
  std::string text() const { return std::to_string(value()); }

 private:
  std::array<uint64_t, 4> lanes_ = {1, 2, 3, 4};
};

}  // namespace lte
