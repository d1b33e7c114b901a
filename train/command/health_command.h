// `lte_train health MODEL --data D`: whether all of a network works, as a table.
#pragma once

#include <string>

#include "lte/cli/cli.h"
#include "train/loop/model_health.h"

namespace lte::train {

/// Adds the subcommand. @return it, to ask whether it was given
CLI::App* add_health_command(CLI::App& app, HealthOptions* options);

/// The figures as a table for people, and the faults under it.
std::string health_table(const HealthReport& report);

/// measure_health(), the JSON file, and the table.
std::string run_health(const HealthOptions& options);

}  // namespace lte::train
