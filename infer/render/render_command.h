// What lte_render does between its command line and its exit code.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "infer/common/embedding_flags.h"
#include "infer/common/renderer.h"
#include "infer/common/scene_source.h"
#include "infer/common/tool_options.h"
#include "infer/render/edit_flags.h"
#include "infer/render/exposure.h"
#include "infer/render/gather_flags.h"
#include "infer/render/quality.h"

namespace lte::infer {

/// The command line as it stands. The flags themselves check its words.
struct RenderRequest : SceneSource {
  std::string checkpoint, camera, out;
  int turntable = 0;  ///< cameras; 0: no turntable
  bool resume = false;
  bool one_exposure = false;  ///< that of the first picture is that of all
  EmbeddingFlags embedding;
  EditFlags edit;
  std::string size = "512x512";
  std::string output = "full", mode = "neural";
  int spp = 64, max_depth = 5, direct_samples = 64;
  uint64_t seed = 0;
  bool validate_only = false;
  bool adaptive_direct = false;
  std::string denoise = "auto";
  std::string antialias = std::to_string(kAntialias), metal = "trace";
  std::string untrained_light = "trace";  ///< "trace" or "network"
  std::string quality = "final", sparse = "auto";
  GatherFlags gather;
  GatherSettings gather_settings;  ///< those of the flags, else of the quality
  std::string time_budget;         ///< "0.5s" or "200ms"; empty: none, `quality` counts
  GivenFlags given;                ///< flags of the quality that stand on the command line
  ExposureOptions exposure;
  ToolOptions tool;
  CLI::App* flags = nullptr;  ///< that it was read from: frames remember their flags
};

void add_render_options(CLI::App& app, RenderRequest* request);

/// Loads, renders, writes, and prints one line of times.
/// @throws lte::Error for bad input, CLI::ValidationError for flags that do not go together.
void run_render(const RenderRequest& request);

}  // namespace lte::infer
