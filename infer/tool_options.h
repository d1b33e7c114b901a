// Flags that the tools with a network share, and what they do.
#pragma once

#include <string>

#include "lte/base/cli.h"

namespace lte::infer {

struct ToolOptions {
  CommonOptions common;
  std::string device;        ///< "", cpu or cuda
  double max_memory_mb = 0;  ///< 0: no limit
  bool print_config = false;
};

/// The common options, and --device, --max-memory and --print-config.
void add_tool_options(CLI::App& app, ToolOptions* options);

/// The common options, and the threads of LibTorch.
void apply_tool_options(const ToolOptions& options);

/// Compares this process's resident memory with --max-memory.
/// @param stage  what has just been done, for the message
/// @throws lte::Error if it is above.
void check_memory(const ToolOptions& options, const std::string& stage);

/// The same for memory that is about to be taken.
void check_memory_ahead(const ToolOptions& options, double more_mb, const std::string& what);

/// Fails early where a result could not be written late: the folder of `path` must exist and be
/// writable.
/// @throws lte::Error naming `path`; nothing happens if it is empty.
void check_writable(const std::string& path);

}  // namespace lte::infer
