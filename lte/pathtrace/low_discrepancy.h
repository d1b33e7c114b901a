// Internal: Owen-scrambled Sobol points in padded pairs (Burley, Practical Hash-based Owen
// Scrambling, JCGT 2020).
#pragma once

#include <cstdint>

#include "lte/base/math.h"

namespace lte::pathtrace {

inline uint32_t reverse_bits(uint32_t x) {
  x = __builtin_bswap32(x);
  x = ((x & 0x0f0f0f0fu) << 4) | ((x >> 4) & 0x0f0f0f0fu);
  x = ((x & 0x33333333u) << 2) | ((x >> 2) & 0x33333333u);
  return ((x & 0x55555555u) << 1) | ((x >> 1) & 0x55555555u);
}

/// Laine and Karras's hash: each bit is flipped by a function of the lower ones. Adding the seed
/// first makes every output exactly uniform over seeds.
inline uint32_t scramble_reversed(uint32_t x, uint32_t seed) {
  x += seed;
  x ^= x * 0x6c50b47cu;
  x ^= x * 0xb82f1e52u;
  x ^= x * 0xc7afe638u;
  x ^= x * 0x8d22f6e6u;
  return x;
}

inline uint32_t owen_scramble(uint32_t x, uint32_t seed) {
  return reverse_bits(scramble_reversed(reverse_bits(x), seed));
}

inline float to_unit(uint32_t x) { return static_cast<float>(x >> 8) * 0x1p-24f; }

/// Second dimension of the Sobol sequence, whose generator matrix is Pascal's triangle mod 2;
/// bit-reversed.
inline uint32_t sobol_second_reversed(uint32_t index) {
  uint32_t x = index;
  x ^= (x & 0xaaaaaaaau) >> 1;
  x ^= (x & 0xccccccccu) >> 2;
  x ^= (x & 0xf0f0f0f0u) >> 4;
  x ^= (x & 0xff00ff00u) >> 8;
  x ^= (x & 0xffff0000u) >> 16;
  return x;
}

/// Five dimensions of one randomized point set: a pair for the first direction, a pair and a single
/// for a light sample. Any aligned block of 2^k points has one in each elementary interval of each
/// pair.
class PointSet {
 public:
  template <typename Random>
  explicit PointSet(Random& random) {
    for (uint32_t& seed : seeds_) seed = random.next_u32();
  }
  Vec2 direction(uint32_t index) const { return pair(index, seeds_[0], seeds_[1]); }
  Vec2 light_point(uint32_t index) const {
    return pair(owen_scramble(index, seeds_[2]), seeds_[3], seeds_[4]);
  }
  double light_choice(uint32_t index) const {
    const uint32_t shuffled = owen_scramble(index, seeds_[5]);
    return reverse_bits(scramble_reversed(shuffled, seeds_[6])) * 0x1p-32;
  }

 private:
  static Vec2 pair(uint32_t index, uint32_t seed_x, uint32_t seed_y) {
    return {to_unit(reverse_bits(scramble_reversed(index, seed_x))),
            to_unit(reverse_bits(scramble_reversed(sobol_second_reversed(index), seed_y)))};
  }
  uint32_t seeds_[7];
};

}  // namespace lte::pathtrace
