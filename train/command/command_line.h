// The flags of lte_train beside those that every tool has.
#pragma once

#include "lte/cli/cli.h"
#include "train/command/run.h"

namespace lte::train {

void add_run_options(CLI::App& app, RunOptions* options);

}  // namespace lte::train
