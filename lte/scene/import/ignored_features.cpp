#include "lte/scene/import/ignored_features.h"

#include "lte/base/check.h"

namespace lte::scene {

std::vector<std::string> IgnoredFeatures::lines() const {
  std::vector<std::string> out;
  for (const auto& [key, count] : counts_) {
    out.push_back(concat(key.first, " (", count, " ", key.second, count == 1 ? "" : "s", ")"));
  }
  return out;
}

}  // namespace lte::scene
