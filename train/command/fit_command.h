// `lte_train fit SCENE --out EMBEDDING`: the embedding that answers one scene best.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "lte/cli/cli.h"

namespace lte::train {

/// What the flags say; a build without scenes has none (no_fit.cpp).
struct FitOptions;

class FitCommand {
 public:
  /// Adds the subcommand, which parses into this object, and its common options into `common`.
  FitCommand(CLI::App& app, CommonOptions* common);
  ~FitCommand();
  FitCommand(const FitCommand&) = delete;
  FitCommand& operator=(const FitCommand&) = delete;

  bool parsed() const { return command_ != nullptr && command_->parsed(); }

  /// Writes the embedding, whole or not at all, and the JSON file.
  /// @return lines for the user
  /// @throws lte::Error of one line for a scene that cannot be read or has no light, a model or
  ///         embedding that does not fit, and what cannot be written
  std::string run(const CommonOptions& common);

 private:
  std::unique_ptr<FitOptions> options_;
  const CLI::App* command_ = nullptr;
};

}  // namespace lte::train
