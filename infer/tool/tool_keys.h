// Keys of --set that the tools share (lte/cli/set_keys.h).
#pragma once

#include "infer/tool/tool_options.h"
#include "lte/cli/scene_source.h"
#include "lte/cli/set_keys.h"

namespace lte::infer {

/// environment_turn.
void add_scene_keys(SetKeys* keys, SceneSource* source);
/// device, precision and max_memory.
void add_network_keys(SetKeys* keys, ToolOptions* options);
/// The common options and --print-config, of tools whose network has its options as keys.
void add_plain_tool_options(CLI::App& app, ToolOptions* options);

}  // namespace lte::infer
