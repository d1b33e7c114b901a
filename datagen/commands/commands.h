// What the subcommands of lte_datagen share. Each is in a file of its own, x_command.{h,cpp}: it
// adds its flags and, when it is chosen, leaves in `*body` what main is to run.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "lte/cli/command_files.h"
#include "lte/cli/scene_flags.h"
#include "lte/scene/scene.h"

namespace lte::datagen {

using CommandBody = std::function<void()>;

inline constexpr const char* kSceneFormats = ".gltf, .glb, .pbrt, .obj or .ply";

/// How to load a scene, and what to do with it before use.
struct SceneOptions {
  SceneFlags loading;
  std::string environment;          ///< "R,G,B" or a picture; empty: the scene's own
  double environment_turn = 0;      ///< degrees about +Y
  std::vector<std::string> lights;  ///< "auto" or "x,y,z,power": luminaires to add
  std::string up = "y";             ///< axis that points up in the file
};

/// Adds --environment, --environment-turn, --add-light, --up and the flags of scene_flags.h.
void add_scene_options(CLI::App& app, SceneOptions* options);

/// Notes the scene and the environment of `options` as what a command reads.
void add_scene_files(const std::string& scene, const SceneOptions& options, CommandFiles* files);

/// Puts the environment of `options`, if it names one, in the place of the scene's own, and adds
/// its luminaires.
/// @throws lte::Error if only a turn is given, the picture cannot be read, or a luminaire is none.
void apply_lighting(const SceneOptions& options, scene::Scene* scene);

/// Loads a scene, applies `options`, and warns about what of it is not understood and where it has
/// no light. Says how much of it is metal.
scene::Scene load_and_report(const std::string& path, const SceneOptions& options);

/// The line that --validate-only prints for a scene that can be used.
std::string validation_line(const std::string& path, const scene::Scene& scene);

/// Writes `text` to `path` unless that is empty.
void write_json(const std::string& path, const std::string& text);

}  // namespace lte::datagen
