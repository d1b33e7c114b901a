// What lte_train does beside training: `lte_train fit`, `health` and `average`.
#pragma once

#include <optional>
#include <string>

#include "lte/cli/cli.h"
#include "train/command/average_command.h"
#include "train/command/fit_command.h"
#include "train/command/health_command.h"

namespace lte::train {

class Subcommands {
 public:
  /// Adds them to `app`, which parses into this object and `common`.
  Subcommands(CLI::App& app, CommonOptions* common);
  Subcommands(const Subcommands&) = delete;
  Subcommands& operator=(const Subcommands&) = delete;

  /// Runs the one that was given. @return its lines for the user; nothing if none was given
  /// @throws lte::Error as its function does
  std::optional<std::string> run(const CommonOptions& common);

 private:
  FitCommand fit_;
  HealthOptions health_options_;
  AverageOptions average_options_;
  const CLI::App *health_, *average_;
};

}  // namespace lte::train
