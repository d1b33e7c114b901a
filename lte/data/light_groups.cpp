#include "lte/data/light_groups.h"

#include <cstddef>

namespace lte::data {

std::vector<Rgb> sum_groups(std::span<const Rgb> values, int64_t groups, double factor) {
  if (groups <= 0) return {};
  const size_t count = values.size() / static_cast<size_t>(groups);
  std::vector<Rgb> out(count);
  for (size_t i = 0; i < count; ++i) {
    for (size_t g = 0; g < static_cast<size_t>(groups); ++g) out[i] += values[g * count + i];
    out[i] *= static_cast<float>(factor);
  }
  return out;
}

}  // namespace lte::data
