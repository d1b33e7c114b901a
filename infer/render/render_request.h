// The command line of lte_render.
#pragma once

#include <cstdint>
#include <string>

#include <CLI/CLI.hpp>

#include "infer/render/attention_flags.h"
#include "infer/render/edit_flags.h"
#include "infer/render/exposure.h"
#include "infer/render/gather_flags.h"
#include "infer/render/quality.h"
#include "infer/renderer/embedding_flags.h"
#include "infer/renderer/renderer.h"
#include "infer/tool/scene_source.h"
#include "infer/tool/tool_options.h"

namespace lte::infer {

/// The command line as it stands. The flags themselves check its words.
struct RenderRequest : SceneSource {
  std::string checkpoint, camera, out;
  bool named_by_scene = false;  ///< `out`, where --out is not given: never replaces a file
  int turntable = 0;            ///< cameras; 0: no turntable
  bool resume = false;
  bool one_exposure = false;  ///< that of the first picture is that of all
  EmbeddingFlags embedding;
  EditFlags edit;
  AttentionFlags attention;
  std::string size = "512x512";
  std::string output = "full", mode = "neural";
  std::vector<float> point;  ///< X, Y, Z of outputs "attention" and "incident"; empty: not given
  int spp = 64, max_depth = 5, direct_samples = 64;
  uint64_t seed = 0;
  bool validate_only = false;
  bool adaptive_direct = false;
  std::string denoise = "auto";
  std::string antialias = std::to_string(kAntialias), metal = "trace";
  int reflections = kReflections;
  std::string untrained_light = "trace";  ///< "trace" or "network"
  std::string quality = "final", sparse = "auto";
  GatherFlags gather;
  std::string check = "on";
  std::string time_budget;  ///< "0.5s" or "200ms"; empty: none, `quality` counts
  GivenFlags given;         ///< flags of the quality that stand on the command line
  ExposureOptions exposure;
  ToolOptions tool;
  CLI::App* flags = nullptr;  ///< that it was read from: frames remember their flags
};

void add_render_options(CLI::App& app, RenderRequest* request);

/// What it asks of a picture, but for what a time budget decides.
RenderSettings settings_of(const RenderRequest& request);

/// @throws lte::Error naming a flag that needs --mode neural, or --indirect gather
void check_dial(const RenderRequest& request);

}  // namespace lte::infer
