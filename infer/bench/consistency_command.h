// The command line of lte_bench consistency.
#pragma once

#include <string>

#include "infer/bench/consistency.h"
#include "lte/cli/cli.h"
#include "lte/cli/scene_flags.h"

namespace lte::infer {

struct ConsistencyRequest {
  std::string scene, checkpoint, camera;  ///< empty: as the help says
  std::string size = "160x120";
  ConsistencyOptions options;
  SceneFlags loading;
};

void add_consistency_options(CLI::App& command, ConsistencyRequest* request);

/// Measures, prints a table, and writes --json.
/// @throws lte::Error for bad input, and a scene whose light the model does not know
void run_consistency(const ConsistencyRequest& request, const CommonOptions& common);

}  // namespace lte::infer
