// What a scene, a sample file or a data set holds, as JSON and as text for people.
#pragma once

#include <filesystem>

#include <nlohmann/json.hpp>

#include "lte/data/scene_sample.h"
#include "lte/scene/scene.h"

namespace lte::datagen {

using Json = nlohmann::ordered_json;

/// Describes a scene: {"kind": "scene", "name", "triangles", "stored_triangles", ..,
/// "texture_list": [{"width", "height", "bytes", "uses"}], "camera_list",
/// "light_groups": [{"name", "kind", "power_w": [r, g, b]}], "bounds", "unit", "ignored", "metal":
/// {"share_of_area", "by_gltf_default", "note"} where there is any,
/// "geometry": what scene::inspect() counts, {"degenerate_triangles", "duplicate_triangles", ..}}.
Json scene_info(const scene::Scene& scene);
/// Describes a baked scene: {"kind": "sample", "name", "scene_points", "query_points", ..}.
Json sample_info(const data::SceneSample& sample);
/// Describes a data set: {"kind": "dataset", "scenes", "splits": {..}, ..}. Reads dataset.json
/// alone, unless `deep` asks to read and check every sample too.
Json dataset_info(const std::filesystem::path& directory, bool deep);

/// Radiant power that the emissive instances and punctual lights of each group send out, in W by
/// channel. A directional light counts 0, since no scene bounds its power.
std::vector<Rgb> group_powers(const scene::Scene& scene);

/// Formats `info` as YAML, an entry of a list a line.
std::string to_yaml(const Json& info);

}  // namespace lte::datagen
