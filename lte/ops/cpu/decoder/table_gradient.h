// The gradient of the query decoder by the table of what its queries read of the latents.
#pragma once

#include <cstdint>
#include <vector>

#include "lte/base/unfilled_vector.h"
#include "lte/ops/cpu/kernels/kernels.h"

namespace lte::ops {

/// What a run of queries sums up of it, a tile of queries at a time. While a tile is in the caches,
/// each latent has its part of all pairs that read it; latents that no query reads take neither
/// time nor memory.
class TableGradient {
 public:
  /// @param entry  floats of a latent
  TableGradient(int64_t latents, int64_t entry)
      : entry_(entry),
        values_(static_cast<size_t>(latents * entry)),
        is_read_(static_cast<size_t>(latents)),
        pairs_(static_cast<size_t>(latents)),
        next_(static_cast<size_t>(latents)) {}

  /// Adds the part of a tile.
  /// @param near       table and neighbours of the tile's queries
  /// @param by_sums    gradient by the sums over the neighbours, interleaved, of these queries
  /// @param positions  [queries * K, blocks * kBlock]
  void add(const NeighbourTable<float>& near, const float* by_sums, const float* positions) {
    sort_pairs(near.index, near.queries * near.K);
    for (const int64_t j : latents_) {
      int32_t& count = pairs_[j];
      sum_kernels<float>().table_gradient(
          {near.table + j * near.stride, by_sums, near.blocks, near.layers,
           rows_.data() + next_[j] - count, count, near.K, positions, is_read_[j] != 0},
          values_.data() + j * entry_);
      is_read_[j] = 1;
      count = 0;
    }
  }

  bool is_read(int64_t latent) const { return is_read_[latent] != 0; }
  /// Of a latent that is read.
  const float* of(int64_t latent) const { return values_.data() + latent * entry_; }

 private:
  /// Pairs in the order of their latents, those of latent j up to rows_[next_[j]].
  void sort_pairs(const int64_t* index, int64_t count) {
    latents_.clear();
    for (int64_t i = 0; i < count; ++i) {
      if (pairs_[index[i]]++ == 0) latents_.push_back(index[i]);
    }
    int32_t before = 0;
    for (const int64_t j : latents_) {
      next_[j] = before;
      before += pairs_[j];
    }
    rows_.resize(static_cast<size_t>(count));
    for (int64_t i = 0; i < count; ++i) rows_[next_[index[i]]++] = static_cast<int32_t>(i);
  }

  int64_t entry_;
  UnfilledVector<float> values_;  ///< [latents, entry]
  std::vector<uint8_t> is_read_;  ///< by latent
  std::vector<int32_t> pairs_;    ///< of the tile, by latent; zero between tiles
  std::vector<int32_t> next_;     ///< by latent
  std::vector<int64_t> latents_;  ///< of the tile, in the order in which queries read them
  std::vector<int32_t> rows_;     ///< of the tile, by latent
};

}  // namespace lte::ops
