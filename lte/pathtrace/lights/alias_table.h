// Draws from a discrete distribution in constant time.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "lte/pathtrace/blocks/path_kernels.h"

namespace lte::pathtrace {

/// Walker/Vose alias table: O(1) draws from a discrete distribution.
class AliasTable {
 public:
  AliasTable() = default;
  explicit AliasTable(const std::vector<double>& weights);
  bool empty() const { return probability_.empty(); }
  size_t size() const { return probability_.size(); }
  /// @param u  uniform in [0, 1), of 32 bits: with fewer, tables of millions of entries would be
  /// drawn unevenly
  uint32_t sample(double u, float* probability) const {
    const double position = u * static_cast<double>(size());
    const auto cell = std::min(static_cast<uint32_t>(position), static_cast<uint32_t>(size() - 1));
    const uint32_t index = position - cell < threshold_[cell] ? cell : alias_[cell];
    *probability = probability_[index];
    return index;
  }
  AliasColumns columns() const {
    return {threshold_.data(), probability_.data(), alias_.data(), static_cast<uint32_t>(size())};
  }
  float probability(uint32_t index) const { return probability_[index]; }

 private:
  std::vector<float> threshold_, probability_;
  std::vector<uint32_t> alias_;
};

}  // namespace lte::pathtrace
