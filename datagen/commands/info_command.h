// lte_datagen info.
#pragma once

#include "datagen/commands/commands.h"

namespace lte::datagen {

/// Says what a scene, a sample file or a data set holds.
void add_info_command(CLI::App& app, CommandBody* body);

}  // namespace lte::datagen
