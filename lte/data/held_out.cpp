#include "lte/data/held_out.h"

#include <nlohmann/json.hpp>

#include "lte/base/check.h"
#include "lte/base/safetensors.h"
#include "lte/data/held_out_list.h"

namespace lte::data {
namespace {

/// What a sample file says of the scene that it was baked from; empty where it says nothing.
struct Source {
  std::string name, geometry;
};

Source source_of(const std::filesystem::path& sample) {
  try {
    const SafetensorsFile file(sample);
    const auto text = [&](const char* key) {
      const auto found = file.metadata().find(key);
      return found == file.metadata().end() ? std::string() : found->second;
    };
    return {text("name"), text("geometry")};
  } catch (const Error&) {
    return {};
  }
}

}  // namespace

const std::vector<HeldOutScene>& held_out_scenes() {
  static const std::vector<HeldOutScene> scenes = [] {
    std::vector<HeldOutScene> list;
    const nlohmann::json known = nlohmann::json::parse(kHeldOutJson);
    for (const auto& [name, geometry] : known.items())
      list.push_back({name, geometry.get<std::string>()});
    return list;
  }();
  return scenes;
}

void refuse_held_out(const std::filesystem::path& directory,
                     const std::vector<DatasetEntry>& entries) {
  for (const DatasetEntry& entry : entries) {
    const Source source = source_of(scene_path(directory, entry.name));
    for (const HeldOutScene& scene : held_out_scenes()) {
      LTE_CHECK(entry.name != scene.name && source.name != scene.name &&
                    source.geometry != scene.geometry,
                directory.string(), ": scene \"", entry.name, "\" is ", scene.name,
                " of assets/scenes/outside, a test set: nothing is trained or tuned on it");
    }
  }
}

}  // namespace lte::data
