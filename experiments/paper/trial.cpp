#include "experiments/paper/trial.h"

#include <utility>

#include <nlohmann/json.hpp>
#include <torch/utils.h>

#include "bench/begin_command.h"
#include "lte/base/check.h"
#include "lte/base/config.h"
#include "lte/base/file.h"
#include "lte/cli/numbers.h"

namespace lte::experiments {

void add_config_options(CLI::App& command, Trial* trial) {
  command.add_option("--config", trial->config, "Training configuration (.yaml)")->required();
  command.add_option("--set", trial->overrides, "Override a key: key=value")->take_all();
}

void add_data_option(CLI::App& command, Trial* trial, const std::string& what) {
  command.add_option("--data", trial->data, what)->required();
}

void add_test_option(CLI::App& command, Trial* trial) {
  command.add_option("--test", trial->test, "Data set whose test split is scored")->required();
  command.add_option("--also", trial->also, "Others, scored in \"also\"");
}

void add_seconds_option(CLI::App& command, Trial* trial) {
  command.add_option("--seconds", trial->seconds, "Processor time of training")
      ->check(positive_number())
      ->capture_default_str();
}

void add_count(CLI::App& command, const std::string& flag, int64_t* value, int least,
               const std::string& text) {
  command.add_option(flag, *value, text)
      ->check(least > 0 ? positive_number() : non_negative_number())
      ->capture_default_str();
}

void add_choice(CLI::App& command, const std::string& flag, std::string* value,
                const std::vector<std::string>& words, const std::string& text) {
  command.add_option(flag, *value, text)->check(CLI::IsMember(words))->capture_default_str();
}

void begin_trial(const Trial& trial, const std::string& sample) {
  CommandFiles files;
  files.reads("--config", trial.config);
  files.reads("--checkpoint", trial.checkpoint);
  files.reads("SAMPLE", sample);
  bench::begin_command(trial.common, &files);
  torch::manual_seed(trial.seed);
}

train::TrainConfig training_config(const Trial& trial, const std::vector<std::string>& more) {
  std::vector<std::string> overrides = trial.overrides;
  overrides.push_back("data.root=" + nlohmann::json(trial.data).dump());
  overrides.push_back(concat("seed=", trial.seed));
  overrides.insert(overrides.end(), more.begin(), more.end());
  return train::TrainConfig::read(Config::load(trial.config, overrides));
}

void write_report(const Trial& trial, nlohmann::json report) {
  if (trial.common.json.empty()) return;
  if (report.is_object()) report["seed"] = trial.seed;
  write_file(trial.common.json, report.dump(1) + "\n");
}

int64_t trained_parameters(const torch::nn::Module& network) {
  int64_t count = 0;
  for (const at::Tensor& parameter : network.parameters())
    count += parameter.requires_grad() ? parameter.numel() : 0;
  return count;
}

}  // namespace lte::experiments
