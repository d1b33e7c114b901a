// lte_datagen info.
#pragma once

#include <nlohmann/json.hpp>

#include "datagen/commands/commands.h"

namespace lte::datagen {

/// What `lte_datagen info` says of a scene, a sample file or the folder of a data set.
/// @param deep  reads and checks every sample of a data set
/// @throws lte::Error naming what cannot be read
nlohmann::ordered_json describe(const SceneSource& source, bool deep);

/// Adds `lte_datagen info`.
void add_info_command(CLI::App& app, CommandBody* body);

}  // namespace lte::datagen
