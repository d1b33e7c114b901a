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

#include "lte/base/random.h"
#include "lte/pathtrace/blocks/low_discrepancy.h"
#include "lte/pathtrace/blocks/path_block.h"
#include "lte/pathtrace/blocks/tile_sequence.h"

namespace lte::pathtrace {

/// Where the numbers of a path come from.
enum class Sampling {
  Sobol,  ///< stratified over the bounces that matter
  Random  ///< independent: what the gain is measured against
};

/// The numbers that lanes need at one vertex, 32 bits each: to_unit() makes them floats.
struct LightNumbers {
  alignas(64) uint32_t point_x[kBlock], point_y[kBlock], choice[kBlock];
};
struct DirectionNumbers {
  alignas(64) uint32_t x[kBlock], y[kBlock];
};

/// The paths of a block are numbered as they are added. A path's numbers depend on its stream, set
/// and place in the set alone, neither on the block nor on how far any path goes.
class PathSampler {
 public:
  /// Vertex 0 is the query point; from this one on numbers are independent.
  static constexpr int kStratifiedVertices = 5;
  static constexpr int kJointSize = 64;

  /// @param set_size  paths of each randomized point set
  /// @param leading   dimensions of the sequence before those of paths, which others use; 0 in sets
  ///                  of fewer than kJointSize paths
  PathSampler(Sampling sampling, int set_size, int leading = 0);

  /// What is drawn from here on belongs to (seed, stream). A set has to be started next.
  void start_stream(uint64_t seed, uint64_t stream);
  /// The next paths belong to a new set, scrambled independently of those before.
  void start_set();
  /// Leaves out the next paths of the set, which others take.
  void skip_paths(uint32_t count) { go_to(index_ + count); }
  /// The next path is this one of the set.
  void go_to(uint32_t index) {
    number_ += uint64_t{index} - index_;
    index_ = index;
  }
  /// Takes the next path of the set into the block; up to kBlock of them.
  void add_path();
  /// Empties the block. The set goes on.
  void clear();

  int paths() const { return paths_; }

  /// Numbers of a light sample at vertex `vertex`, for the paths `path[0 ... count)`.
  void light(int vertex, const int32_t* path, int count, LightNumbers* out);
  /// Numbers of the direction out of a vertex.
  void direction(int vertex, const int32_t* path, int count, DirectionNumbers* out);
  /// Numbers of the Russian roulette at vertex 1 or later.
  void roulette(int vertex, const int32_t* path, int count, uint32_t* out);

 private:
  static constexpr int kFirst = 3;  // after the light sample at vertex 0
  static constexpr int kPerVertex = 6;
  static constexpr int kDimensions = (kStratifiedVertices - 1) * kPerVertex + 2;
  static constexpr int kSlots = kFirst + kDimensions;
  static_assert(kSobolDimensions == kTileDimensions + kDimensions);

  /// Numbers first ... first + count - 1 of the six that belong together: the direction out of a
  /// vertex, and light sample and roulette at the next, `vertex`; or the three at the query point.
  void draw(int vertex, int first, int numbers, const int32_t* path, int count,
            uint32_t* const* out);

  const Sampling sampling_;
  const bool joint_;
  const int leading_;
  const uint32_t last_index_;  ///< of sets, after a shuffle too
  Rng scrambles_;
  uint64_t independent_ = 0;  ///< start of the stream of independent numbers
  uint32_t index_ = 0;        ///< of the next path in its set
  uint64_t number_ = 0;       ///< of the next path in its stream
  int paths_ = 0, sets_ = 0;

  std::array<uint32_t, kBlock> index_of_path_;
  std::array<int32_t, kBlock> set_of_path_;
  std::array<uint64_t, kBlock> key_of_path_;
  // The seeds of the sets in the block: a scramble a slot, and a shuffle a vertex.
  std::array<std::array<uint32_t, kBlock + 1>, kSlots> scramble_seeds_;
  std::array<std::array<uint32_t, kBlock + 1>, kStratifiedVertices + 1> shuffle_seeds_;

  // What draw() gathers of the lanes that it works on.
  alignas(64) std::array<uint32_t, kBlock> lane_index_, lane_shuffled_;
  alignas(64) std::array<int32_t, kBlock> lane_set_;
  alignas(64) std::array<uint64_t, kBlock> lane_key_;
};

}  // namespace lte::pathtrace
