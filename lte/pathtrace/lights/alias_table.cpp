#include "lte/pathtrace/lights/alias_table.h"

namespace lte::pathtrace {

AliasTable::AliasTable(const std::vector<double>& weights) {
  double total = 0;
  for (const double weight : weights) total += weight;
  if (!(total > 0)) return;
  const size_t count = weights.size();
  threshold_.resize(count);
  probability_.resize(count);
  alias_.resize(count);
  std::vector<double> scaled(count);
  std::vector<uint32_t> small, large;
  for (uint32_t i = 0; i < count; ++i) {
    probability_[i] = static_cast<float>(weights[i] / total);
    scaled[i] = weights[i] / total * static_cast<double>(count);
    alias_[i] = i;
    (scaled[i] < 1 ? small : large).push_back(i);
  }
  while (!small.empty() && !large.empty()) {
    const uint32_t low = small.back(), high = large.back();
    small.pop_back();
    threshold_[low] = static_cast<float>(scaled[low]);
    alias_[low] = high;
    scaled[high] -= 1 - scaled[low];
    if (scaled[high] < 1) {
      large.pop_back();
      small.push_back(high);
    }
  }
  // What is left is 1 up to rounding, except entries without weight, which must stay undrawable.
  for (const uint32_t i : large) threshold_[i] = 1;
  for (const uint32_t i : small) threshold_[i] = weights[i] > 0 ? 1.0f : 0.0f;
}

}  // namespace lte::pathtrace
