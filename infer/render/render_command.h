// What lte_render does between its command line and its exit code.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "infer/common/renderer.h"
#include "infer/common/tool_options.h"
#include "infer/render/exposure.h"
#include "infer/render/quality.h"
#include "lte/cli/scene_flags.h"

namespace lte::infer {

/// The command line as it stands. The flags themselves check its words.
struct RenderRequest {
  std::string scene, checkpoint, camera, out;
  std::string size = "512x512";
  std::string output = "full", mode = "neural";
  int spp = 64, max_depth = 5, direct_samples = 64;
  int64_t scene_points = 0;
  uint64_t seed = 0;
  bool rescale = true, validate_only = false;
  std::string up = "y";
  std::string prune = "auto";
  std::string environment;          ///< "R,G,B" or a picture; empty: that of the scene
  double environment_turn = 0;      ///< degrees about +Y
  std::vector<std::string> lights;  ///< "auto" or "x,y,z,power": luminaires to add
  std::string antialias = std::to_string(kAntialias), metal = "trace";
  std::string quality = "final", sparse = "auto";
  std::string time_budget;  ///< "0.5s" or "200ms"; empty: none, `quality` counts
  GivenFlags given;         ///< flags of the quality that stand on the command line
  SceneFlags loading;
  ExposureOptions exposure;
  ToolOptions tool;
};

void add_render_options(CLI::App& app, RenderRequest* request);

/// Loads, renders, writes, and prints one line of times.
/// @throws lte::Error for bad input, CLI::ValidationError for flags that do not go together.
void run_render(const RenderRequest& request);

}  // namespace lte::infer
