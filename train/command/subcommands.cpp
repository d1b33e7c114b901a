#include "train/command/subcommands.h"

namespace lte::train {

Subcommands::Subcommands(CLI::App& app, CommonOptions* common)
    : fit_(app, common),
      health_(add_health_command(app, &health_options_)),
      average_(add_average_command(app, &average_options_)) {}

std::optional<std::string> Subcommands::run(const CommonOptions& common) {
  health_options_.json = common.json;
  average_options_.log_file = common.log_file;
  if (fit_.parsed()) return fit_.run(common);
  if (health_->parsed()) return run_health(health_options_);
  if (average_->parsed()) return average_models(average_options_);
  return std::nullopt;
}

}  // namespace lte::train
