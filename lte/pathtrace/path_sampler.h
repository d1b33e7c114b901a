// Internal: the random numbers of a path, vertex by vertex: Owen-scrambled Sobol points over the
// first bounces, independent numbers beyond.
//
// A set of paths is one randomized point set. Its dimensions in the order of what they explain: the
// direction out of vertex 0, the light sample and the roulette at vertex 1, the direction out of
// vertex 1, and so on. Light sampled at vertex 0 itself never meets these in one product and has a
// point set of its own. In sets of at least kJointSize paths all dimensions come from one Sobol
// sequence; in smaller ones, whose points fill high dimensions badly, each vertex takes the first
// six under a shuffle of its own (Burley's padding). Measured: docs/benchmarks.md.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "lte/base/math.h"
#include "lte/base/random.h"
#include "lte/pathtrace/low_discrepancy.h"

namespace lte::pathtrace {

/// Where the numbers of a path come from.
enum class Sampling {
  Sobol,  ///< stratified over the bounces that matter
  Random  ///< independent: what the gain is measured against
};

class PathSampler {
 public:
  /// Vertex 0 is the query point; from this one on numbers are independent.
  static constexpr int kStratifiedVertices = 5;
  static constexpr int kJointSize = 64;

  /// Two streams, so that the first vertex does not depend on how far paths go: direct light is the
  /// same at any depth.
  PathSampler(Sampling sampling, uint64_t seed, uint64_t stream)
      : sampling_(sampling), scrambles_(seed, stream), rng_(mix_bits(seed + 1), stream) {}

  /// A new set of `size` paths, scrambled independently of those before.
  void start_set(int size) {
    for (uint32_t& seed : scramble_seeds_) seed = scrambles_.next_u32();
    for (uint32_t& seed : shuffle_seeds_) seed = scrambles_.next_u32();
    joint_ = size >= kJointSize;
    mask_ = std::bit_ceil(static_cast<uint32_t>(size)) - 1;
    index_ = 0;
  }

  /// Before each path of the set.
  void next_path() {
    if (sampling_ == Sampling::Random) return;
    values_.fill(0);
    add_points(0, 3, shuffled(0));
    if (joint_) {
      add_points(kFirst, kSobolDimensions, index_);
    } else {
      for (int v = 0; v < kStratifiedVertices; ++v) {
        add_points(kFirst + v * kPerVertex, std::min(kPerVertex, kValues - kFirst - v * kPerVertex),
                   shuffled(1 + v));
      }
    }
    ++index_;
  }

  Vec2 direction(int vertex) { return pair(vertex, kFirst + vertex * kPerVertex); }
  Vec2 light_point(int vertex) {
    return pair(vertex, vertex == 0 ? 0 : kFirst + (vertex - 1) * kPerVertex + 2);
  }
  double light_choice(int vertex) {
    return bits(vertex, vertex == 0 ? 2 : kFirst + (vertex - 1) * kPerVertex + 4) * 0x1p-32;
  }
  /// At vertex 1 or later.
  float roulette(int vertex) {
    return to_unit(bits(vertex, kFirst + (vertex - 1) * kPerVertex + 5));
  }

 private:
  static constexpr int kFirst = 3;  // after the light sample at vertex 0
  static constexpr int kPerVertex = 6;
  static constexpr int kValues = kFirst + kSobolDimensions;
  static_assert(kSobolDimensions == (kStratifiedVertices - 1) * kPerVertex + 2);

  /// A permutation of the set that keeps its aligned blocks together.
  uint32_t shuffled(int set) const { return owen_scramble(index_, shuffle_seeds_[set]) & mask_; }

  /// The first `count` dimensions of Sobol point `index`, bit-reversed, to values_[at ...].
  void add_points(int at, int count, uint32_t index) {
    for (; index != 0; index &= index - 1) {
      const auto& row = kSobolMatrix[std::countr_zero(index)];
      for (int d = 0; d < count; ++d) values_[at + d] ^= row[d];
    }
  }

  uint32_t bits(int vertex, int slot) {
    const bool stratified = vertex < kStratifiedVertices && sampling_ == Sampling::Sobol;
    if (!stratified) return rng_.next_u32();
    // Only now: most paths end before they have asked for all.
    return reverse_bits(scramble_reversed(values_[slot], scramble_seeds_[slot]));
  }
  Vec2 pair(int vertex, int slot) {
    const float x = to_unit(bits(vertex, slot));
    return {x, to_unit(bits(vertex, slot + 1))};
  }

  const Sampling sampling_;
  Rng scrambles_, rng_;
  bool joint_ = false;
  uint32_t index_ = 0, mask_ = 0;
  std::array<uint32_t, kValues> scramble_seeds_{}, values_{};  ///< values before their scrambling
  std::array<uint32_t, kStratifiedVertices + 1> shuffle_seeds_{};
};

}  // namespace lte::pathtrace
