// The flags of lte_render for a scene that changes from picture to picture.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "lte/cli/command_files.h"

namespace lte::infer {

struct EditFlags {
  std::string script;

  bool any() const { return !script.empty(); }
};

/// Adds --edit.
void add_edit_flags(CLI::App& app, EditFlags* flags);

void claim_edits(const EditFlags& flags, CommandFiles* files);

}  // namespace lte::infer
