// Internal: what the writers of engines' files share.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "lte/bake/lightmap.h"
#include "lte/base/file_set.h"
#include "lte/base/math.h"
#include "lte/scene/scene.h"

namespace lte::bake {

/// The name of an instance's node: letters, digits and underscores, no two alike, and none that an
/// importer takes for an order, as Godot does with names that end in "_col" or "-noimp".
std::string node_name(const Lightmap& map, size_t instance);

/// The scene as engines get it: nodes have node_name()s, metal is matt as it was baked, and where
/// the light map has all light, no lamp lights the scene a second time.
scene::Scene engine_scene(const Lightmap& map);

/// E / π of the sum over layers, what a white diffuse surface sends out; [height, width].
std::vector<Rgb> radiosity(const Lightmap& map);

/// What radiosity()'s values are, in a file.
inline constexpr const char* kRadiosityUnits =
    "E / pi in W sr^-1 m^-2, linear Rec.709; radiance of a surface: albedo times that";

/// Adds radiosity() as half floats.
void write_radiosity_exr(const Lightmap& map, FileSet* files);

/// The text with each {{key}} replaced by its value.
std::string filled(std::string text,
                   const std::vector<std::pair<std::string, std::string>>& values);

/// Adds scene.glb, and lightmap.json, which says how the light map came about.
/// @param image  file name of the light map
/// @param units  as of write_lightmap_json(), or empty for its own
void write_scene_and_record(const Lightmap& map, const std::string& image, const std::string& units,
                            FileSet* files);

}  // namespace lte::bake
