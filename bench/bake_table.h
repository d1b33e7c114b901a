// lte_bench bake: seconds against error of light maps, by lte_bake's estimator and by what else
// could bake them.
#pragma once

#include <string>
#include <vector>

#include "lte/cli/cli.h"
#include "lte/cli/scene_flags.h"

namespace lte::bench {

struct BakeTableRequest {
  std::vector<std::string> scenes;
  int texels = 256000;
  int measured = 5000;  ///< texels that a reference knows
  int reference_paths = 2048;
  std::string checkpoint;  ///< of the row "network"; empty: the shipped model
  std::string cycles;      ///< a Python that has bpy; empty: no such row
  uint64_t seed = 1;
  bool resume = false;  ///< keep the scenes that the file of --json has, of the same settings
  SceneFlags loading;
};

void add_bake_table_options(CLI::App& command, BakeTableRequest* request);

/// Prints a table a scene, and writes JSON where it is asked for, whenever a scene has ended.
void run_bake_table(const BakeTableRequest& request, const CommonOptions& common);

}  // namespace lte::bench
