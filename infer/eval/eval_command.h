// What lte_eval does between its command line and its exit code.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "infer/eval/measure/bootstrap.h"
#include "infer/tool/tool_options.h"

namespace lte::infer {

struct EvalRequest {
  std::string config, checkpoint, data, split, baselines, report;
  std::string fit_baselines, out;
  int64_t scene_points = 0;
  bool denoise_references = false;
  BootstrapSettings bootstrap;
  ToolOptions tool;
};

void add_eval_options(CLI::App& app, EvalRequest* request);

/// Fills in what the training configuration of --config says where the command line is silent: its
/// data set, and the model of its run directory.
/// @throws lte::Error naming the file.
void read_run_config(EvalRequest* request);

/// Makes the folder of --report, if one is named, and sees that `file` can be written there.
/// @throws lte::Error naming the folder or the file
std::filesystem::path make_report_folder(const std::string& report, const char* file);

/// Evaluates and prints a table; or, with --fit-baselines, writes a baselines file.
/// @throws lte::Error for bad input, CLI::ValidationError for flags that do not go together.
void run_eval(const EvalRequest& request);

}  // namespace lte::infer
