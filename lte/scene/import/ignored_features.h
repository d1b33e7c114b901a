// What an importer leaves out of a scene.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace lte::scene {

/// Counts of what an importer leaves out, for Scene::ignored.
class IgnoredFeatures {
 public:
  /// @param what  e.g. "normal map"
  /// @param unit  what is counted, singular, e.g. "material"
  void add(const std::string& what, const std::string& unit, int64_t count = 1) {
    counts_[{what, unit}] += count;
  }
  /// "normal map (3 materials)", in the order of the alphabet.
  std::vector<std::string> lines() const;

 private:
  std::map<std::pair<std::string, std::string>, int64_t> counts_;
};

}  // namespace lte::scene
