// The command line of lte_render.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>

#include "infer/render/edit_flags.h"
#include "infer/render/exposure.h"
#include "infer/renderer/embedding_flags.h"
#include "infer/renderer/renderer.h"
#include "infer/tool/tool_options.h"
#include "lte/cli/scene_source.h"
#include "lte/cli/set_keys.h"

namespace lte::infer {

/// The command line as it stands. The flags themselves check its words.
struct RenderRequest : SceneSource {
  std::string checkpoint, camera, out;
  bool named_by_scene = false;  ///< `out`, where --out is not given: never replaces a file
  int turntable = 0;            ///< cameras; 0: no turntable
  bool resume = false;
  EmbeddingFlags embedding;
  EditFlags edit;
  std::string size = "512x512";
  std::string output = "full", integrator = "gather", quality = "final";
  std::string time;  ///< "0.5s" or "200ms"; empty: the quality's passes
  int spp = 0;       ///< 0: the quality's passes
  uint64_t seed = 0;
  bool validate_only = false;
  RenderSettings settings;  ///< what keys set
  int64_t records = render::CacheSettings().records;
  bool check = true;
  ExposureOptions exposure;
  int fps = 24;  ///< of a video
  ToolOptions tool;
  SetKeys keys;
  CLI::App* flags = nullptr;  ///< that it was read from: frames remember their flags
};

void add_render_options(CLI::App& app, RenderRequest* request);

/// What it asks of a picture.
/// @throws lte::Error of one line for flags and keys that would be ignored
RenderSettings settings_of(const RenderRequest& request);

}  // namespace lte::infer
