// lte_datagen generate.
#pragma once

#include "datagen/commands/commands.h"

namespace lte::datagen {

/// Makes a data set of procedural scenes.
void add_generate_command(CLI::App& app, CommandBody* body);

}  // namespace lte::datagen
