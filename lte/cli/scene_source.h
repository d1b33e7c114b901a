// Which scene a tool works on: the flags that name it and change it on the way in.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "lte/cli/command_files.h"
#include "lte/cli/scene_flags.h"
#include "lte/scene/scene.h"

namespace lte {

struct SceneSource {
  std::string scene;
  std::string up = "y";
  std::string environment;          ///< "R,G,B" or a picture; empty: that of the scene
  double environment_turn = 0;      ///< degrees about +Y
  std::vector<std::string> lights;  ///< "auto" or "x,y,z,power": luminaires to add
  SceneFlags loading;
};

/// Adds --up, --environment, --add-light and the flags of scene_flags.h.
void add_scene_options(CLI::App& app, SceneSource* source);

/// Notes the scene and the picture of its environment as what a command reads.
void claim_scene(const SceneSource& source, CommandFiles* files);

/// The scene as the flags want it.
/// @param camera  a word that scene::find_cameras() reads: what --add-light auto gives light to;
///                empty: the scene's first camera, or else the automatic one
/// @throws lte::Error as load_scene(), and naming the flag
scene::Scene load_source(const SceneSource& source, const std::string& camera = "auto");

/// Adds a luminaire that --add-light names to a scene.
/// @param camera  as above
/// @return what was added, for people
/// @throws lte::Error naming what it is not
std::string add_light(const std::string& light, const std::string& camera, scene::Scene* scene);

/// Says what a scene is in a line of the log, and what of its file was ignored.
void describe(const scene::Scene& scene, const std::string& path);

/// The result of --validate-only, on standard output, under --quiet too.
void print_valid_scene(const scene::Scene& scene, const std::string& path);

}  // namespace lte
