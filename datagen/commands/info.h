// What a scene, a sample file or a data set holds, for people and as JSON.
#pragma once

#include <filesystem>

#include <nlohmann/json.hpp>

#include "lte/data/scene_sample.h"
#include "lte/scene/cleanup/cleanup.h"
#include "lte/scene/scene.h"

namespace lte::datagen {

using Json = nlohmann::ordered_json;

/// {"kind":"scene","name","triangles","stored_triangles",..,"texture_list":[{"width","height","bytes",
/// "uses"}],"camera_list","light_groups":[{"name","kind","power_w":[r,g,b]}],"bounds","unit",
/// "ignored","geometry":{..}}, the last as `report` has it.
Json scene_info(const scene::Scene& scene, const scene::CleanupReport& report);
/// The same with a report of its own.
Json scene_info(const scene::Scene& scene);
/// {"degenerate_triangles","duplicate_triangles",..}: the fields of the report.
Json cleanup_info(const scene::CleanupReport& report);
/// {"kind":"sample","name","scene_points","query_points",..}.
Json sample_info(const data::SceneSample& sample);
/// {"kind":"dataset","scenes","splits":{..},..}; reads dataset.json alone unless `deep`, which
/// validates each sample.
Json dataset_info(const std::filesystem::path& directory, bool deep);

/// Radiant power that the emissive instances and punctual lights of each group send out, W by
/// channel. Directional lights have none that a scene bounds: 0.
std::vector<Rgb> group_powers(const scene::Scene& scene);

/// "key: value" lines, lists indented.
std::string to_text(const Json& info);

}  // namespace lte::datagen
