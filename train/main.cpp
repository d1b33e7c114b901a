// lte_train: only argv and the exit code live here; the work is train::run(), which tests call too.
#include <iostream>
#include <string>

#include "lte/base/cli.h"
#include "lte/base/memory.h"
#include "train/report.h"
#include "train/run.h"

namespace {

constexpr const char* kExamples = R"(Examples:
  lte_train --config configs/model/paper.yaml --dry-run
  lte_train --config configs/train/demo.yaml --set data.root=data/rooms --out runs/demo
  lte_train --config configs/train/demo.yaml --set data.root=data/rooms --out runs/demo --resume
  lte_train report runs/demo
A run directory holds checkpoint.safetensors, model.safetensors, model_best.safetensors, log.jsonl, config.yaml, tensorboard/ and previews/.
Ctrl-C finishes the step and writes a checkpoint. docs/training.md explains every key.)";

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Trains a light transport embedding on baked scenes.", "lte_train"};
  app.footer(kExamples);
  lte::CommonOptions common;
  lte::train::RunOptions options;
  app.add_option("--config", options.config, "YAML file; see configs/");
  app.add_option("--set", options.overrides, "Override a key of the configuration: key=value")
      ->take_all();
  app.add_option("--out", options.output, "Run directory (key `output`)");
  app.add_option("--seed", options.seed, "Seed of everything random (key `seed`)");
  app.add_option("--device", options.device, "cpu or cuda")
      ->check(CLI::IsMember({"cpu", "cuda"}))
      ->capture_default_str();
  app.add_option("--stop-after", options.stop_after,
                 "End this session after so many steps, with a checkpoint; 0: never")
      ->check(CLI::NonNegativeNumber);
  auto* resume =
      app.add_flag("--resume", options.resume, "Go on from the run directory's checkpoint");
  auto* print = app.add_flag("--print-config", options.print_config,
                             "Print the merged configuration and stop");
  auto* dry = app.add_flag("--dry-run", options.dry_run,
                           "Print parameters, shapes and memory, without data, and stop");
  auto* check = app.add_flag("--validate-only", options.validate_only,
                             "Check configuration and data set and stop");
  dry->excludes(resume)->excludes(print)->excludes(check);
  check->excludes(resume)->excludes(print);
  lte::add_common_options(app, &common);
  std::string run, page;
  auto* report =
      app.add_subcommand("report", "Write a run's curves, scenes and times as one HTML page");
  report->add_option("RUN", run, "Run directory")->required();
  report->add_option("--out", page, "The page; by default RUN/report.html");

  int signal = 0;
  const int status = lte::run_tool(app, argc, argv, [&] {
    lte::apply_common_options(common);
    lte::keep_freed_memory();
    if (report->parsed()) {
      std::cout << lte::train::write_run_report(run, page);
      return;
    }
    if (options.config.empty()) throw CLI::RequiredError("--config");
    options.json = common.json;
    options.threads = common.threads;
    const lte::train::RunResult result = lte::train::run(options);
    std::cout << result.text;
    signal = result.signal;
  });
  return status == 0 && signal != 0 ? 128 + signal : status;
}
