// The flags of lte_render for a scene that changes from picture to picture.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "lte/cli/command_files.h"

namespace lte::infer {

struct EditFlags {
  std::string script, video, save_scene;

  bool any() const { return !script.empty(); }
};

/// Adds --edit, --video and --save-scene.
void add_edit_flags(CLI::App& app, EditFlags* flags);

/// Refuses flags that do not go together.
/// @param out  --out
void check_edit_flags(const EditFlags& flags, const std::string& out);

void claim_edits(const EditFlags& flags, CommandFiles* files);

}  // namespace lte::infer
