// Counter-based random numbers: the n-th number of a stream depends on (seed, stream, n) alone, so
// results do not depend on threads or on order.
#pragma once

#include <cstdint>

namespace lte {

__extension__ using Wide = unsigned __int128;

/// A bijective mixer of 64 bits (the finalizer of SplitMix64, Steele et al. 2014).
constexpr uint64_t mix_bits(uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

constexpr uint64_t hash_combine(uint64_t a, uint64_t b) {
  return mix_bits(
      a ^ (mix_bits(b + 0x9e3779b97f4a7c15ULL) + 0x9e3779b97f4a7c15ULL + (a << 6) + (a >> 2)));
}

/// PCG32 (O'Neill 2014) whose stream is chosen by (seed, stream).
class Rng {
 public:
  explicit Rng(uint64_t seed, uint64_t stream = 0)
      : state_(0), increment_((hash_combine(seed, stream) << 1) | 1) {
    next_u32();
    state_ += mix_bits(seed + 0x632be59bd9b4e019ULL) ^ hash_combine(stream, seed);
    next_u32();
  }

  uint32_t next_u32() {
    const uint64_t old = state_;
    state_ = old * 6364136223846793005ULL + increment_;
    const auto shifted = static_cast<uint32_t>(((old >> 18) ^ old) >> 27);
    const auto rotation = static_cast<uint32_t>(old >> 59);
    return (shifted >> rotation) | (shifted << ((32 - rotation) & 31));
  }
  uint64_t next_u64() { return (static_cast<uint64_t>(next_u32()) << 32) | next_u32(); }

  /// Uniform in [0, 1), with 24 random bits.
  float uniform() { return static_cast<float>(next_u32() >> 8) * 0x1p-24f; }
  float uniform(float low, float high) { return low + (high - low) * uniform(); }

  /// Uniform in [0, n), n > 0. The bias is below n / 2^64.
  uint64_t below(uint64_t n) {
    return static_cast<uint64_t>((static_cast<Wide>(next_u64()) * n) >> 64);
  }

 private:
  uint64_t state_, increment_;
};

}  // namespace lte
