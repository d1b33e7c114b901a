// Internal: the Sobol sequence and its Owen scrambling by hashing (Burley, Practical Hash-based
// Owen Scrambling, JCGT 2020).
#pragma once

#include <array>
#include <cstdint>

namespace lte::pathtrace {

constexpr uint32_t reverse_bits(uint32_t x) {
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

inline constexpr int kSobolDimensions = 28;

/// One dimension's primitive polynomial, without its first and last coefficient, and the initial
/// direction numbers: new-joe-kuo-6.21201 (Joe and Kuo 2008).
struct SobolPolynomial {
  int degree;  ///< 0 for the first dimension, the van der Corput sequence
  uint32_t coefficients;
  std::array<uint32_t, 7> initial;
};

inline constexpr std::array<SobolPolynomial, kSobolDimensions> kSobolPolynomials{{
    {0, 0, {}},
    {1, 0, {1}},
    {2, 1, {1, 3}},
    {3, 1, {1, 3, 1}},
    {3, 2, {1, 1, 1}},
    {4, 1, {1, 1, 3, 3}},
    {4, 4, {1, 3, 5, 13}},
    {5, 2, {1, 1, 5, 5, 17}},
    {5, 4, {1, 1, 5, 5, 5}},
    {5, 7, {1, 1, 7, 11, 19}},
    {5, 11, {1, 1, 5, 1, 1}},
    {5, 13, {1, 1, 1, 3, 11}},
    {5, 14, {1, 3, 5, 5, 31}},
    {6, 1, {1, 3, 3, 9, 7, 49}},
    {6, 13, {1, 1, 1, 15, 21, 21}},
    {6, 16, {1, 3, 1, 13, 27, 49}},
    {6, 19, {1, 1, 1, 15, 7, 5}},
    {6, 22, {1, 3, 1, 15, 13, 25}},
    {6, 25, {1, 1, 5, 5, 19, 61}},
    {7, 1, {1, 3, 7, 11, 23, 15, 103}},
    {7, 4, {1, 3, 7, 13, 13, 15, 69}},
    {7, 7, {1, 1, 3, 13, 7, 35, 63}},
    {7, 8, {1, 3, 5, 9, 1, 25, 53}},
    {7, 14, {1, 3, 1, 13, 9, 35, 107}},
    {7, 19, {1, 3, 1, 5, 27, 61, 31}},
    {7, 21, {1, 1, 5, 11, 19, 41, 61}},
    {7, 28, {1, 3, 5, 3, 3, 13, 69}},
    {7, 31, {1, 1, 7, 13, 1, 19, 1}},
}};

/// Bit-reversed direction numbers, [bit of the index][dimension]: what a set bit of the index
/// flips.
using SobolMatrix = std::array<std::array<uint32_t, kSobolDimensions>, 32>;

constexpr SobolMatrix make_sobol_matrix() {
  SobolMatrix matrix{};
  for (int d = 0; d < kSobolDimensions; ++d) {
    const SobolPolynomial& p = kSobolPolynomials[d];
    std::array<uint32_t, 32> v{};
    for (int k = 0; k < 32; ++k) {
      if (p.degree == 0) {
        v[k] = 1u << (31 - k);
      } else if (k < p.degree) {
        v[k] = p.initial[k] << (31 - k);
      } else {
        v[k] = v[k - p.degree] ^ (v[k - p.degree] >> p.degree);
        for (int j = 1; j < p.degree; ++j) {
          if ((p.coefficients >> (p.degree - 1 - j)) & 1) v[k] ^= v[k - j];
        }
      }
      matrix[k][d] = reverse_bits(v[k]);
    }
  }
  return matrix;
}

inline constexpr SobolMatrix kSobolMatrix = make_sobol_matrix();

}  // namespace lte::pathtrace
