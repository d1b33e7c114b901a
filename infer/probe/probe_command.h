// What lte_probe does between its command line and its exit code.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "infer/renderer/embedding_flags.h"
#include "infer/tool/scene_source.h"
#include "infer/tool/tool_options.h"

namespace lte::infer {

/// The command line as it stands.
struct ProbeRequest : SceneSource {
  std::string points, out, checkpoint;
  std::string mode = "neural", indirect = "gather", check = "on";
  std::optional<int64_t> rays;  ///< nothing: as many as suit the mode
  int max_depth = 5;
  double target_error = 0;
  uint64_t seed = 0;
  bool validate_only = false;
  EmbeddingFlags embedding;
  ToolOptions tool;
  bool indirect_given = false;
  std::string network_flag;  ///< one of the network's that stands on the command line; or empty

  bool by_paths() const { return mode == "reference" || indirect == "paths"; }
  bool needs_network() const {
    return !by_paths() && (indirect == "network" || indirect == "decoded");
  }
};

void add_probe_options(CLI::App& app, ProbeRequest* request);

/// Loads, asks, writes the table, and prints a line.
/// @throws lte::Error for bad input, CLI::ValidationError for flags that do not go together.
void run_probe(const ProbeRequest& request);

}  // namespace lte::infer
