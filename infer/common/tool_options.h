// Flags that the tools with a network share, and what they do.
#pragma once

#include <string>

#include "infer/common/device.h"
#include "lte/cli/cli.h"
#include "lte/nn/precision.h"

namespace lte::infer {

struct ToolOptions {
  CommonOptions common;
  std::string device;              ///< "", cpu or cuda
  std::string precision = "fp32";  ///< or bf16
  double max_memory_mb = 0;        ///< 0: no limit
  bool print_config = false;
};

/// --precision and --max-memory.
void add_network_options(CLI::App& app, std::string* precision, double* max_memory_mb);

/// The common options, and --device, --precision, --max-memory and --print-config.
void add_tool_options(CLI::App& app, ToolOptions* options);

/// "fp32" or "bf16". Says so once if the device is a processor that has to compute bfloat16 from
/// float32.
nn::Precision choose_precision(const std::string& word, Device device = Device::Cpu);

/// The common options, and the threads of LibTorch.
void apply_tool_options(const ToolOptions& options);

/// Fails early where a result could not be written late: the folder of `path` must exist and be
/// writable.
/// @throws lte::Error naming `path`; nothing happens if it is empty.
void check_writable(const std::string& path);

}  // namespace lte::infer
