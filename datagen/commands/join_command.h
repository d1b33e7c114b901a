// lte_datagen join.
#pragma once

#include "datagen/commands/commands.h"

namespace lte::datagen {

void add_join_command(CLI::App& app, CommandBody* body);

}  // namespace lte::datagen
