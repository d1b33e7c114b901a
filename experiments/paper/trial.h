// What the subcommands of experiment_paper have in common: how they are added, their flags for data
// and training, and the report that they write.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json_fwd.hpp>
#include <torch/nn/module.h>

#include "lte/cli/cli.h"
#include "train/config.h"

namespace lte::experiments {

/// What one run is given. A subcommand has the flags of it that it adds.
struct Trial {
  std::string config, data, test, checkpoint;
  std::vector<std::string> overrides, also;
  double seconds = 60;  ///< processor time of training
  uint64_t seed = 1;
  CommonOptions common;
};

void add_config_options(CLI::App& command, Trial* trial);  ///< --config and --set
void add_data_option(CLI::App& command, Trial* trial, const std::string& what);
void add_test_option(CLI::App& command, Trial* trial);  ///< --test and --also
void add_seconds_option(CLI::App& command, Trial* trial);

/// A number of what the text says, of at least `least`, 0 or 1, with its default shown.
void add_count(CLI::App& command, const std::string& flag, int64_t* value, int least,
               const std::string& text);
/// One of some words, with the default shown.
void add_choice(CLI::App& command, const std::string& flag, std::string* value,
                const std::vector<std::string>& words, const std::string& text);

/// Adds a subcommand: the flags that add_flags adds to it, and then --seed and the common ones.
/// @return  runs it with what was given
template <typename Request>
std::function<void()> add_trial(CLI::App* app, const std::string& name, const std::string& text,
                                void (*add_flags)(CLI::App&, Request*),
                                void (*run)(const Request&)) {
  const auto request = std::make_shared<Request>();
  CLI::App* command = app->add_subcommand(name, text);
  add_flags(*command, request.get());
  command->add_option("--seed", request->seed, "Of all that is drawn")->capture_default_str();
  add_common_options(*command, &request->common);
  return [request, run] { run(*request); };
}

/// Checks the files, applies the common options and seeds the weights.
/// @param sample  a further file that is read, by its flag's name in messages; empty: none
void begin_trial(const Trial& trial, const std::string& sample = "");

/// The configuration of a training run on --data.
/// @param more  keys that win over --set
train::TrainConfig training_config(const Trial& trial, const std::vector<std::string>& more = {});

/// Writes --json if it was given, with the seed.
void write_report(const Trial& trial, nlohmann::json report);

/// Numbers that training changes.
int64_t trained_parameters(const torch::nn::Module& network);

}  // namespace lte::experiments
