#include "lte/base/checksum.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "lte/base/random.h"

namespace lte {

// Each step is a bijection of its lane: two inputs that differ in a single word never meet again.
void Checksum::add(const void* bytes, size_t size) {
  const auto* from = static_cast<const unsigned char*>(bytes);
  std::array<uint64_t, 4> block{};
  for (size_t done = 0; done < size; done += sizeof(block)) {
    const size_t taken = std::min(sizeof(block), size - done);
    if (taken < sizeof(block)) block = {};
    std::memcpy(block.data(), from + done, taken);
    for (size_t i = 0; i < block.size(); ++i)
      lanes_[i] = std::rotl((lanes_[i] ^ block[i]) * 0x9e3779b97f4a7c15ULL, 31);
  }
  lanes_[0] = hash_combine(lanes_[0], size);
}

uint64_t Checksum::value() const {
  uint64_t hash = 0;
  for (const uint64_t lane : lanes_) hash = hash_combine(hash, lane);
  return hash;
}

}  // namespace lte
