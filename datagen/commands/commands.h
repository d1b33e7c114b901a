// The subcommands of lte_datagen. Each adds its flags and, when chosen, leaves in `*body` what main
// is to run.
#pragma once

#include <functional>
#include <string>

#include <CLI/CLI.hpp>

#include "lte/scene/scene.h"

namespace lte::datagen {

using CommandBody = std::function<void()>;

void add_generate_command(CLI::App& app, CommandBody* body);
void add_bake_command(CLI::App& app, CommandBody* body);
void add_probe_command(CLI::App& app, CommandBody* body);
void add_info_command(CLI::App& app, CommandBody* body);

inline constexpr const char* kSceneFormats = ".gltf, .glb, .pbrt, .obj or .ply";

/// What is done to a scene between loading and use.
struct SceneOptions {
  std::string cleanup;          ///< list of what of its geometry to put right
  std::string environment;      ///< "R,G,B" or a picture; empty: the scene's own
  double environment_turn = 0;  ///< degrees about +Y
};

/// Adds --cleanup, --environment and --environment-turn.
void add_scene_options(CLI::App& app, SceneOptions* options);

/// Loads a scene, does to it what `options` say, and says what of it is not understood, as
/// warnings.
scene::Scene load_and_report(const std::string& path, const SceneOptions& options);

/// --validate-only: one line on standard output if the scene can be used.
void print_validation(const std::string& path, const scene::Scene& scene);

/// Writes `text` to `path` unless that is empty.
void write_json(const std::string& path, const std::string& text);

}  // namespace lte::datagen
