#include "lte/nn/model_metadata.h"

#include <charconv>

#include "lte/base/check.h"
#include "lte/base/safetensors.h"

namespace lte::nn {
namespace {

constexpr int64_t kDefaultScenePoints = ModelMetadata().scene_points;

int64_t scene_points_of(const SafetensorsFile& file) {
  const auto found = file.metadata().find("scene_points");
  if (found == file.metadata().end()) return kDefaultScenePoints;
  const std::string& text = found->second;
  int64_t count = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), count);
  LTE_CHECK(error == std::errc() && end == text.data() + text.size() && count >= 0,
            file.path().string(), ": metadata scene_points is \"", text, "\", expected a number");
  if (count == 0) return kDefaultScenePoints;
  return count;
}

/// Models of before pruning do not say.
bool scene_points_pruned_of(const SafetensorsFile& file) {
  const auto found = file.metadata().find("scene_points_pruned");
  if (found == file.metadata().end()) return false;
  LTE_CHECK(found->second == "true" || found->second == "false", file.path().string(),
            ": metadata scene_points_pruned is \"", found->second, "\", expected true or false");
  return found->second == "true";
}

}  // namespace

ModelMetadata read_model_metadata(const std::filesystem::path& path) {
  const SafetensorsFile file(path);
  return {scene_points_of(file), scene_points_pruned_of(file)};
}

}  // namespace lte::nn
