// The pairs of queries and neighbours in the order of the neighbours.
#pragma once

#include <cstdint>
#include <vector>

namespace lte::ops {

/// Pairs of a query and a neighbour, by latent: those of latent j are rows[start[j]] up to
/// rows[start[j + 1] - 1], ascending.
struct PairsByLatent {
  std::vector<int32_t> rows;
  std::vector<int64_t> start;

  PairsByLatent(const int64_t* index, int64_t count, int64_t m) : rows(count), start(m + 1) {
    for (int64_t i = 0; i < count; ++i) ++start[index[i] + 1];
    for (int64_t j = 0; j < m; ++j) start[j + 1] += start[j];
    std::vector<int64_t> next(start.begin(), start.end() - 1);
    for (int64_t i = 0; i < count; ++i) rows[next[index[i]]++] = static_cast<int32_t>(i);
  }
};

}  // namespace lte::ops
