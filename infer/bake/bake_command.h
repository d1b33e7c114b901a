// What lte_bake does between its command line and its exit code.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "infer/renderer/embedding_flags.h"
#include "infer/tool/tool_options.h"
#include "lte/bake/atlas.h"
#include "lte/cli/scene_source.h"
#include "lte/cli/set_keys.h"
#include "lte/render/integrator.h"

namespace lte::infer {

/// The command line as it stands.
struct BakeRequest : SceneSource {
  std::string out, checkpoint;
  std::string integrator = "gather", quality = "preview", include = "full", format = "gltf";
  std::string time;  ///< empty: as long as `quality` takes
  double error = 0;  ///< relative, of indirect light; 0: none
  bool by_light = false;
  bake::AtlasOptions atlas;
  std::filesystem::path three;
  std::string probes;  ///< "", auto or NXxNYxNZ
  int max_depth = 5;
  int64_t records = render::CacheSettings().records;
  uint64_t seed = 0;
  bool validate_only = false;
  EmbeddingFlags embedding;
  ToolOptions tool;
  SetKeys keys;
  CLI::App* flags = nullptr;  ///< that it was read from

  bool needs_network() const { return integrator == "network"; }
};

void add_bake_options(CLI::App& app, BakeRequest* request);

/// Loads, bakes, writes the folder, and prints a line.
/// @throws lte::Error for bad input, also for flags that would be ignored.
void run_bake(const BakeRequest& request);

}  // namespace lte::infer
