// What the subcommands of lte_datagen share. Each is in a file of its own, x_command.{h,cpp}: it
// adds its flags and, when it is chosen, leaves in `*body` what main is to run.
#pragma once

#include <functional>
#include <string>

#include <CLI/CLI.hpp>

#include "lte/cli/scene_source.h"
#include "lte/scene/scene.h"

namespace lte::datagen {

using CommandBody = std::function<void()>;

inline constexpr const char* kSceneFormats = ".gltf, .glb, .pbrt, .obj or .ply";

/// Adds --environment-turn and the flags of lte/cli/scene_source.h.
void add_source_options(CLI::App& app, SceneSource* source);

/// The scene as its flags want it.
/// @throws lte::Error as lte::load_source(), and where --environment-turn has no environment
scene::Scene load_lit(const SceneSource& source);

/// As load_lit(), and warns about what of the scene is not understood and where it has no light.
/// Says how much of it is metal.
scene::Scene load_and_report(const SceneSource& source);

/// Writes `text` to `path` unless that is empty.
void write_json(const std::string& path, const std::string& text);

}  // namespace lte::datagen
