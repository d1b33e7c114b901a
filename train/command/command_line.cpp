#include "train/command/command_line.h"

#include <cstdint>

namespace lte::train {
namespace {

void add_configuration(CLI::App& app, RunOptions* options) {
  app.add_option("--config", options->config, "YAML file; see configs/");
  app.add_option("--set", options->overrides, "Override a key of the configuration: key=value")
      ->take_all();
  app.add_option("--out", options->output, "Run directory (key `output`)");
  app.add_option("--seed", options->seed, "Seed of everything random (key `seed`)");
  app.add_option("--device", options->device, "cpu or cuda")
      ->check(CLI::IsMember({"cpu", "cuda"}))
      ->capture_default_str();
  app.add_option("--stop-after", options->stop_after,
                 "End this session after so many steps, with a checkpoint; 0: never")
      ->check(CLI::NonNegativeNumber);
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

}  // namespace lte::train
