// The command that lte_train is without a subcommand: it trains, or does what one of the flags says
// instead (--dry-run, --validate-only, --find-lr, ...).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "lte/cli/cli.h"

namespace lte::train {

struct RunOptions {
  std::string config;                  ///< YAML file; empty when resuming: the run's own
  std::vector<std::string> overrides;  ///< --set key=value
  std::optional<uint64_t> seed;        ///< --seed, over the key `seed`
  std::string output;                  ///< --out, over the key `output`; empty: the key counts
  std::string device = "cpu";
  std::string json;                      ///< file of the result for machines; empty: none
  std::string log_file;                  ///< --log-file, which is open already; empty: none
  int64_t stop_after = 0;                ///< steps of this session; 0: all
  std::string init_weights;              ///< --init-weights, over the key; empty: the key counts
  std::vector<std::string> init_except;  ///< --init-except, likewise
  int64_t find_lr = 0;                   ///< steps of a sweep of learning rates instead; 0: none
  int threads = 0;                       ///< of LibTorch; 0: its default
  bool resume = false, dry_run = false, print_config = false, validate_only = false;
  bool overfit_one_scene = false;
};

struct RunResult {
  std::string text{};  ///< for standard output
  int signal = 0;      ///< that ended training early, after a checkpoint; else 0
};

/// Adds the flags of lte_train beside those that every tool has.
void add_run_options(CLI::App& app, RunOptions* options);

/// @throws lte::Error with one line for the user; CLI::RequiredError without a configuration.
RunResult run(const RunOptions& options);

}  // namespace lte::train
