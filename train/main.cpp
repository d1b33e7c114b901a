// lte_train: only argv, printing and the exit code live here; train/command has the work.
#include <iostream>

#include "lte/base/process_memory.h"
#include "lte/cli/cli.h"
#include "train/command/subcommands.h"
#include "train/command/train_command.h"

namespace {

constexpr const char* kExamples = R"(Examples:
  lte_train --config configs/model/paper.yaml --dry-run
  lte_train --config configs/train/demo.yaml --set data.root=data/rooms --out runs/demo
  lte_train --out runs/demo --resume
  lte_train --config my.yaml --set data.root=data/homes --out runs/homes \
      --init-weights runs/demo/model.safetensors
  lte_train --config my.yaml --set data.root=data/homes --out runs/homes --find-lr
  lte_train fit room.glb --out room.safetensors --time 120s
  lte_train health runs/demo/model.safetensors --data data/rooms
  lte_train average runs/demo/model.safetensors runs/homes/model.safetensors --out both.safetensors
A run directory holds checkpoint.safetensors and the ones before it, checkpoint_best.safetensors,
model.safetensors, model_best.safetensors, start.safetensors, log.jsonl, config.yaml, tensorboard/
and previews/; it may be moved. --resume takes the newest checkpoint that is whole.
Ctrl-C finishes the step and writes a checkpoint. docs/training.md is the guide,
docs/training-keys.md explains every key.)";

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Trains a light transport embedding on baked scenes.", "lte_train"};
  app.footer(kExamples);
  lte::CommonOptions common;
  lte::train::RunOptions options;
  lte::train::add_run_options(app, &options);
  lte::add_common_options(app, &common);
  lte::train::Subcommands subcommands(app, &common);

  int signal = 0;
  const int status = lte::run_tool(app, argc, argv, [&] {
    lte::apply_common_options(common);
    lte::keep_freed_memory();
    if (const auto text = subcommands.run(common)) {
      std::cout << *text;
      return;
    }
    options.json = common.json;
    options.log_file = common.log_file;
    options.threads = common.threads;
    const lte::train::RunResult result = lte::train::run(options);
    std::cout << result.text;
    signal = result.signal;
  });
  return status == 0 && signal != 0 ? 128 + signal : status;
}
