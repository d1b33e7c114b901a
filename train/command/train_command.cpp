#include "train/command/train_command.h"

#include <chrono>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <system_error>

#include <ATen/Parallel.h>

#include "lte/base/check.h"
#include "lte/base/file.h"
#include "lte/base/json_number.h"
#include "lte/base/log.h"
#include "lte/base/process_memory.h"
#include "lte/cli/command_files.h"
#include "lte/cli/numbers.h"
#include "lte/data/dataset.h"
#include "lte/nn/device.h"
#include "train/command/dry_run.h"
#include "train/command/run_files.h"
#include "train/distributed/rank.h"
#include "train/log/json.h"
#include "train/loop/overfit.h"
#include "train/loop/rate_sweep.h"
#include "train/loop/trainer.h"

namespace lte::train {
namespace {

void add_configuration(CLI::App& app, RunOptions* options) {
  app.add_option("--config", options->config,
                 "YAML file; see configs/. With --resume the run's own unless given");
  app.add_option("--set", options->overrides, "Override a key of the configuration: key=value")
      ->take_all();
  app.add_option("--out", options->output, "Run directory (key `output`)");
  app.add_option("--seed", options->seed, "Seed of everything random (key `seed`)");
  app.add_option("--device", options->device, "cpu or cuda")
      ->check(CLI::IsMember({"cpu", "cuda"}))
      ->capture_default_str();
  app.add_option("--stop-after", options->stop_after,
                 "End this session after so many steps, with a checkpoint; 0: never")
      ->check(non_negative_number());
}

/// --config, or that of the run that goes on.
std::string config_file(const RunOptions& options) {
  if (!options.config.empty()) return options.config;
  if (!options.resume || options.output.empty())
    throw CLI::RequiredError("--config (or --resume with --out RUN_DIR)");
  return (std::filesystem::path(options.output) / "config.yaml").string();
}

Config load(const RunOptions& options) {
  std::vector<std::string> overrides = options.overrides;
  if (options.seed) overrides.push_back("seed=" + std::to_string(*options.seed));
  // In quotes: a path may hold what YAML takes for syntax.
  if (!options.output.empty()) overrides.push_back("output=" + Json(options.output).dump());
  if (!options.init_weights.empty())
    overrides.push_back("train.init_weights=" + Json(options.init_weights).dump());
  if (!options.init_except.empty())
    overrides.push_back("train.init_except=" + Json(options.init_except).dump());
  return Config::load(config_file(options), overrides);
}

/// No output of this command may replace what it reads. The run's own configuration may change when
/// the run goes on.
void check_files(const RunOptions& options, const TrainConfig& config, CommandFiles* files) {
  const std::filesystem::path own = std::filesystem::path(config.output) / "config.yaml";
  std::error_code error;
  if (!options.resume || !std::filesystem::equivalent(config_file(options), own, error))
    files->reads("--config", config_file(options));
  files->reads_parts("data.root", config.data.root, data::kDatasetParts);
  if (!options.resume) files->reads("--init-weights", config.train.init_weights);
  if (!options.print_config && !options.dry_run && !options.validate_only)
    files->writes_parts("--out", config.output, kRunParts);
  files->writes("--json", options.json);
  files->writes("--log-file", options.log_file);
  files->check();
  files->check_what_was_read();
}

Json summary_json(const TrainConfig& config, const TrainSummary& summary) {
  Json json = {{"output", config.output},
               {"model", model_path(config.output).string()},
               {"step", summary.step},
               {"steps", config.train.steps},
               {"finished", summary.step >= config.train.steps},
               {"loss", summary.loss},
               {"best_val_loss", json_number(summary.best_loss)},
               {"seconds", summary.seconds},
               {"wait_share", summary.wait_share},
               {"bad_scenes", summary.bad_scenes},
               {"peak_rss_mb", peak_rss_mb()}};
  if (summary.validation) {
    for (const auto& [name, value] : summary.validation->fields()) json[name] = json_number(value);
  }
  return json;
}

std::string summary_text(const TrainConfig& config, const TrainSummary& summary) {
  const std::string model = model_path(config.output).string();
  if (summary.step < config.train.steps) {
    return concat(model, ": stopped ", summary.signal != 0 ? "by a signal " : "", "after step ",
                  summary.step, " of ", config.train.steps, "; go on with --resume\n");
  }
  const bool validated = std::isfinite(summary.best_loss);
  const std::string best = validated ? concat(", best validation loss ", summary.best_loss, " in ",
                                              best_model_path(config.output).string())
                                     : "";
  return concat(model, ": ", summary.step, " steps", best, "\n");
}

/// A sweep of learning rates; touches nothing of the run directory but its own file.
RunResult find_learning_rate(const RunOptions& options, const TrainConfig& config,
                             at::Device device) {
  LTE_CHECK(!config.output.empty(), "output: names no run directory; give it with --out RUN_DIR");
  make_directory(config.output);
  const std::filesystem::path path = std::filesystem::path(config.output) / "find_lr.jsonl";
  const RateSweep sweep = sweep_rates(config, device, options.find_lr);
  write_sweep(path, sweep);
  if (!options.json.empty()) {
    const Json json = {{"curve", path.string()},         {"steps", sweep.points.size()},
                       {"steepest", sweep.steepest},     {"lowest", sweep.lowest},
                       {"suggestion", sweep.suggestion}, {"diverged", sweep.diverged}};
    write_file(options.json, json.dump(2) + "\n");
  }
  RunResult result;
  result.text = concat(path.string(), ": ", sweep.points.size(),
                       " steps, the loss falls fastest at ", sweep.steepest, " and is lowest at ",
                       sweep.lowest, sweep.diverged ? ", then blows up" : "",
                       "\nsuggestion: --set train.learning_rate=", sweep.suggestion, "\n");
  return result;
}

RunResult overfit(const RunOptions& options, const TrainConfig& config, at::Device device) {
  const OverfitResult fit = overfit_one_scene(config, device);
  if (!options.json.empty()) {
    const Json json = {{"scene", fit.scene},
                       {"steps", fit.steps},
                       {"queries", fit.queries},
                       {"psnr", fit.psnr},
                       {"loss", json_number(fit.loss)},
                       {"reached", fit.reached()}};
    write_file(options.json, json.dump(2) + "\n");
  }
  RunResult result;
  result.text = concat("scene ", fit.scene, ": PSNR ", fit.psnr, " dB on its ", fit.queries,
                       " queries after ", fit.steps, " steps\n");
  LTE_CHECK(fit.reached(), "--overfit-one-scene: scene ", fit.scene, ": PSNR ", fit.psnr,
            " dB after ", fit.steps, " steps, below ", kOverfitPsnr,
            " dB: more train.steps, another train.learning_rate (--find-lr), or something is wrong "
            "with the data or the network");
  return result;
}

/// One run of this process alone, or this process's part of a run of several.
RunResult train(const RunOptions& options, const TrainConfig& config,
                const std::string& config_text, const Rank& rank, at::Device device) {
  std::unique_ptr<ProcessGroup> group;
  if (rank.count > 1) {
    const std::chrono::seconds timeout(config.train.timeout_s);
    group = std::make_unique<ProcessGroup>(rank, device, timeout);
    log_info("rank ", rank.index, " of ", rank.count);
  }
  TrainSummary summary;
  try {
    Trainer trainer(config, config_text, device, options.resume, group.get());
    summary = trainer.run(options.stop_after);
  } catch (const std::exception& error) {
    if (!group) throw;
    group->explain(error);
  }
  RunResult result;
  result.signal = summary.signal;
  if (!rank.leads()) return result;
  if (!options.json.empty()) write_file(options.json, summary_json(config, summary).dump(2) + "\n");
  result.text = summary_text(config, summary);
  return result;
}

}  // namespace

void add_run_options(CLI::App& app, RunOptions* options) {
  add_configuration(app, options);
  auto* resume = app.add_flag("--resume", options->resume,
                              "Go on from the run directory's newest whole checkpoint");
  auto* init =
      app.add_option("--init-weights", options->init_weights,
                     "Model or checkpoint whose weights a new run starts from: step 0, fresh "
                     "optimizer and schedule (key `train.init_weights`)");
  app.add_option("--init-except", options->init_except,
                 "Prefix of parameter names that stay fresh all the same; may be repeated (key "
                 "`train.init_except`)")
      ->take_all()
      ->needs(init);
  auto* print = app.add_flag("--print-config", options->print_config,
                             "Print the merged configuration and stop");
  auto* dry = app.add_flag("--dry-run", options->dry_run,
                           "Print parameters, shapes and memory, without data, and stop");
  auto* check = app.add_flag("--validate-only", options->validate_only,
                             "Check configuration and data set and stop");
  auto* find = app.add_flag("--find-lr{300}", options->find_lr,
                            "Sweep the learning rate from 1e-6 to 1 in 300 steps (or --find-lr=N), "
                            "write find_lr.jsonl into the run directory, suggest a rate and stop")
                   ->check(CLI::Range(int64_t{10}, int64_t{1000000}));
  auto* overfit = app.add_flag("--overfit-one-scene", options->overfit_one_scene,
                               "Learn one scene by heart, print the PSNR and stop; exit code 1 if "
                               "45 dB are not reached within train.steps");
  init->excludes(resume);
  dry->excludes(resume)->excludes(print)->excludes(check);
  check->excludes(resume)->excludes(print);
  for (auto* tool : {find, overfit})
    tool->excludes(resume)->excludes(print)->excludes(dry)->excludes(check);
  find->excludes(overfit);
}

RunResult run(const RunOptions& options) {
  CommandFiles files;
  const Config yaml = load(options);
  const TrainConfig config = TrainConfig::read(yaml);
  check_files(options, config, &files);
  if (options.threads > 0) at::set_num_threads(options.threads);
  if (options.print_config) return {yaml.to_yaml()};
  if (options.dry_run) {
    const Json report = dry_run(config);
    if (!options.json.empty()) write_file(options.json, report.dump(2) + "\n");
    return {dry_run_table(report)};
  }
  if (options.validate_only) return {check_run_data(config)};
  const Rank rank = rank_from_environment();
  const at::Device device = nn::choose_device(options.device, rank.local, "--device");
  if (options.find_lr == 0 && !options.overfit_one_scene)
    return train(options, config, yaml.to_yaml(), rank, device);
  LTE_CHECK(rank.count == 1, options.find_lr > 0 ? "--find-lr" : "--overfit-one-scene",
            ": runs in one process, not in ", rank.count);
  return options.find_lr > 0 ? find_learning_rate(options, config, device)
                             : overfit(options, config, device);
}

}  // namespace lte::train
