// lte_datagen probe.
#pragma once

#include "datagen/commands/commands.h"

namespace lte::datagen {

/// Path-traces irradiance at the points of a CSV file.
void add_probe_command(CLI::App& app, CommandBody* body);

}  // namespace lte::datagen
