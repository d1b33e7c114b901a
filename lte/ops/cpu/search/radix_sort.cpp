#include "lte/ops/cpu/search/radix_sort.h"

#include <algorithm>
#include <numeric>

namespace lte::ops {

std::vector<int32_t> sort_rows(const std::vector<uint32_t>& key) {
  constexpr int kDigit = 11;
  constexpr size_t kFew = 256;  // for which counting digits takes longer
  std::vector<int32_t> rows(key.size()), other(key.size());
  std::iota(rows.begin(), rows.end(), 0);
  if (key.size() < kFew) {
    std::stable_sort(rows.begin(), rows.end(),
                     [&](int32_t a, int32_t b) { return key[a] < key[b]; });
    return rows;
  }
  const uint32_t top = key.empty() ? 0 : *std::max_element(key.begin(), key.end());
  for (int shift = 0; shift < 32 && top >> shift != 0; shift += kDigit) {
    std::vector<int64_t> start((1 << kDigit) + 1);
    const auto digit = [&](int32_t row) { return key[row] >> shift & ((1 << kDigit) - 1); };
    for (const int32_t row : rows) ++start[digit(row) + 1];
    std::partial_sum(start.begin(), start.end(), start.begin());
    for (const int32_t row : rows) other[start[digit(row)]++] = row;
    rows.swap(other);
  }
  return rows;
}

}  // namespace lte::ops
