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

/// Adds --cleanup: what of a scene's geometry to put right before it is used.
void add_cleanup_option(CLI::App& app, std::string* list);

/// Loads a scene, puts right what `cleanup` lists, and says what of the scene is not understood, as
/// warnings.
scene::Scene load_and_report(const std::string& path, const std::string& cleanup);

/// --validate-only: one line on standard output if the scene can be used.
void print_validation(const std::string& path, const scene::Scene& scene);

/// Writes `text` to `path` unless that is empty.
void write_json(const std::string& path, const std::string& text);

}  // namespace lte::datagen
