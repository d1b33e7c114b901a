// What lte_probe does between its command line and its exit code.
#pragma once

#include <cstdint>
#include <string>

#include "infer/renderer/embedding_flags.h"
#include "infer/tool/tool_options.h"
#include "lte/cli/scene_source.h"
#include "lte/cli/set_keys.h"
#include "lte/render/integrator.h"

namespace lte::infer {

/// The command line as it stands.
struct ProbeRequest : SceneSource {
  std::string points, out, checkpoint;
  std::string integrator = "gather";
  int64_t spp = 0;   ///< 0: as many as suit the integrator
  double error = 0;  ///< relative standard error that paths are to reach; 0: none
  int max_depth = 5;
  int64_t records = render::CacheSettings().records;
  bool check = true;
  uint64_t seed = 0;
  bool validate_only = false;
  EmbeddingFlags embedding;
  ToolOptions tool;
  SetKeys keys;
  CLI::App* flags = nullptr;  ///< that it was read from

  bool by_paths() const { return integrator == "path"; }
  bool needs_network() const { return integrator == "network"; }
};

void add_probe_options(CLI::App& app, ProbeRequest* request);

/// Loads, computes, writes the table, and prints a line.
/// @throws lte::Error for bad input, also for flags that would be ignored.
void run_probe(const ProbeRequest& request);

}  // namespace lte::infer
