#include "lte/data/light_groups.h"

#include <algorithm>
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

std::vector<float> to_floats(std::span<const Half> values) {
  std::vector<float> out(values.size());
  std::transform(values.begin(), values.end(), out.begin(), to_float);
  return out;
}

PointIrradiance sum_groups(const GroupedLight& light, int64_t groups) {
  PointIrradiance sum{sum_groups(light.direct, groups, 1),
                      sum_groups(light.indirect, groups, 1),
                      sum_groups(light.direct_back, groups, 1),
                      sum_groups(light.indirect_back, groups, 1),
                      {}};
  if (light.error.empty()) return sum;
  const size_t count = sum.indirect.size();
  for (size_t i = 0; i < count; ++i) {
    ErrorOfSum front, back;
    for (size_t at = i; at < light.error.size(); at += count) {
      front.add(light.error[at], light.indirect[at] - light.indirect_back[at]);
      back.add(light.error_back[at], light.indirect_back[at]);
    }
    sum.error.push_back(front.relative());
    sum.error.push_back(back.relative());
  }
  return sum;
}

}  // namespace lte::data
