#include "train/command/run.h"

#include <chrono>
#include <cmath>
#include <memory>

#include <ATen/Parallel.h>
#include <nlohmann/json.hpp>

#include "lte/base/check.h"
#include "lte/base/file.h"
#include "lte/base/log.h"
#include "lte/nn/device.h"
#include "train/command/dry_run.h"
#include "train/distributed/rank.h"
#include "train/loop/overfit.h"
#include "train/loop/rate_sweep.h"
#include "train/loop/trainer.h"

namespace lte::train {
namespace {

using Json = nlohmann::ordered_json;

Config load(const RunOptions& options) {
  std::vector<std::string> overrides = options.overrides;
  if (options.seed) overrides.push_back("seed=" + std::to_string(*options.seed));
  // In quotes: a path may hold what YAML takes for syntax.
  if (!options.output.empty()) overrides.push_back("output=" + Json(options.output).dump());
  if (!options.init_weights.empty())
    overrides.push_back("train.init_weights=" + Json(options.init_weights).dump());
  if (!options.init_except.empty())
    overrides.push_back("train.init_except=" + Json(options.init_except).dump());
  return Config::load(options.config, overrides);
}

Json number_or_null(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json summary_json(const TrainConfig& config, const TrainSummary& summary) {
  Json json = {{"output", config.output},
               {"model", model_path(config.output).string()},
               {"step", summary.step},
               {"steps", config.train.steps},
               {"finished", summary.step >= config.train.steps},
               {"loss", summary.loss},
               {"best_val_loss", number_or_null(summary.best_loss)},
               {"seconds", summary.seconds},
               {"wait_share", summary.wait_share},
               {"bad_scenes", summary.bad_scenes},
               {"peak_rss_mb", peak_rss_mb()}};
  if (summary.validation) {
    for (const auto& [name, value] : summary.validation->fields())
      json[name] = number_or_null(value);
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
                       {"loss", number_or_null(fit.loss)},
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

}  // namespace

RunResult run(const RunOptions& options) {
  const Config yaml = load(options);
  const TrainConfig config = TrainConfig::read(yaml);
  if (options.threads > 0) at::set_num_threads(options.threads);
  RunResult result;
  if (options.print_config) {
    result.text = yaml.to_yaml();
    return result;
  }
  if (options.dry_run) {
    const Json report = dry_run(config);
    if (!options.json.empty()) write_file(options.json, report.dump(2) + "\n");
    result.text = dry_run_table(report);
    return result;
  }
  if (options.validate_only) {
    result.text = check_run_data(config);
    return result;
  }
  const World world = world_from_environment();
  const at::Device device = nn::choose_device(options.device, world.local_rank, "--device");
  if (options.find_lr > 0 || options.overfit_one_scene) {
    LTE_CHECK(world.size == 1, options.find_lr > 0 ? "--find-lr" : "--overfit-one-scene",
              ": runs in one process, not in ", world.size);
    return options.find_lr > 0 ? find_learning_rate(options, config, device)
                               : overfit(options, config, device);
  }
  std::unique_ptr<ProcessGroup> group;
  if (world.size > 1) {
    group =
        std::make_unique<ProcessGroup>(world, device, std::chrono::seconds(config.train.timeout_s));
    log_info("rank ", world.rank, " of ", world.size);
  }
  TrainSummary summary;
  try {
    Trainer trainer(config, yaml.to_yaml(), device, options.resume, group.get());
    summary = trainer.run(options.stop_after);
  } catch (const std::exception& error) {
    if (!group) throw;
    group->explain(error);
  }
  result.signal = summary.signal;
  if (!world.leads()) return result;
  if (!options.json.empty()) write_file(options.json, summary_json(config, summary).dump(2) + "\n");
  result.text = summary_text(config, summary);
  return result;
}

}  // namespace lte::train
