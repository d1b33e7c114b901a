// lte_datagen bake.
#pragma once

#include "datagen/commands/commands.h"

namespace lte::datagen {

/// Samples and path-traces one scene into a sample file.
void add_bake_command(CLI::App& app, CommandBody* body);

}  // namespace lte::datagen
