#include "lte/nn/files/model_metadata.h"

#include "lte/base/check.h"
#include "lte/base/safetensors.h"
#include "lte/base/to_number.h"

namespace lte::nn {
namespace {

// What more would take no machine has.
constexpr int64_t kMaxScenePoints = int64_t{1} << 40, kMaxLightPaths = int64_t{1} << 26,
                  kMaxLightDepth = 1024;

/// The metadata `key` if the file has it.
const std::string* find(const SafetensorsFile& file, const char* key) {
  const auto found = file.metadata().find(key);
  return found == file.metadata().end() ? nullptr : &found->second;
}

int64_t count_of(const SafetensorsFile& file, const char* key, int64_t otherwise, int64_t least,
                 int64_t most) {
  const std::string* text = find(file, key);
  if (text == nullptr) return otherwise;
  const auto count = to_number<int64_t>(*text);
  LTE_CHECK(count && *count >= least && *count <= most, file.path().string(), ": metadata ", key,
            " is \"", *text, "\", expected a number from ", least, " to ", most);
  return *count;
}

bool switch_of(const SafetensorsFile& file, const char* key, bool otherwise) {
  const std::string* text = find(file, key);
  if (text == nullptr) return otherwise;
  LTE_CHECK(*text == "true" || *text == "false", file.path().string(), ": metadata ", key, " is \"",
            *text, "\", expected true or false");
  return *text == "true";
}

}  // namespace

std::map<std::string, std::string> ModelMetadata::entries() const {
  return {{"scene_points", std::to_string(scene_points)},
          {"scene_points_pruned", scene_points_pruned ? "true" : "false"},
          {"suns", suns ? "true" : "false"},
          {"light_paths", std::to_string(light_paths)},
          {"light_depth", std::to_string(light_depth)}};
}

ModelMetadata read_model_metadata(const std::filesystem::path& path) {
  const SafetensorsFile file(path);
  const ModelMetadata defaults;
  ModelMetadata metadata;
  metadata.scene_points = count_of(file, "scene_points", defaults.scene_points, 0, kMaxScenePoints);
  // Runs that took all the points of each file wrote 0.
  if (metadata.scene_points == 0) metadata.scene_points = defaults.scene_points;
  metadata.scene_points_pruned =
      switch_of(file, "scene_points_pruned", defaults.scene_points_pruned);
  metadata.suns = switch_of(file, "suns", defaults.suns);
  metadata.light_paths =
      static_cast<int>(count_of(file, "light_paths", defaults.light_paths, 1, kMaxLightPaths));
  metadata.light_depth =
      static_cast<int>(count_of(file, "light_depth", defaults.light_depth, 1, kMaxLightDepth));
  return metadata;
}

}  // namespace lte::nn
