// Flags that the tools with a network share, and what they do.
#pragma once

#include <functional>
#include <string>

#include "lte/cli/cli.h"
#include "lte/runtime/network.h"

namespace lte::infer {

struct ToolOptions {
  CommonOptions common;
  std::string device;              ///< "", cpu or cuda
  std::string precision = "fp32";  ///< or bf16
  double max_memory_mb = 0;        ///< 0: no limit
  bool print_config = false;
};

/// Adds --precision and --max-memory.
void add_network_options(CLI::App& app, std::string* precision, double* max_memory_mb);

/// Adds the common options, and --device, --precision, --max-memory and --print-config.
void add_tool_options(CLI::App& app, ToolOptions* options);

/// Reads "fp32" or "bf16". Warns if the device is a processor that has to compute bfloat16 from
/// float32.
runtime::Precision choose_precision(const std::string& word, runtime::Device device = {});

/// The device, which is logged, and the precision that were chosen.
runtime::NetworkOptions network_options(const ToolOptions& options);

/// Applies the common options, and the threads of LibTorch.
void apply_tool_options(const ToolOptions& options);

/// lte::run_tool(); where the runtime refuses a request, the message ends with those flags of `app`
/// that help: "(--rescale)".
int run_network_tool(CLI::App& app, int argc, char** argv, const std::function<void()>& body);

}  // namespace lte::infer
