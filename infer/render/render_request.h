// The command line of lte_render.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "infer/render/edit_flags.h"
#include "infer/render/exposure.h"
#include "infer/renderer/light_request.h"

namespace lte::infer {

/// The command line as it stands. The flags themselves check its words.
struct RenderRequest : LightRequest {
  std::string camera, out;
  bool named_by_scene = false;  ///< `out`, where --out is not given: never replaces a file
  int turntable = 0;            ///< cameras; 0: no turntable
  bool resume = false;
  EditFlags edit;
  std::string size = "512x512";
  std::string output = "full", quality = "final";
  std::string time;         ///< "0.5s" or "200ms"; empty: the quality's passes
  int spp = 0;              ///< 0: the quality's passes
  RenderSettings settings;  ///< what keys set, but max_depth
  bool check = true;
  ExposureOptions exposure;
  int fps = 24;  ///< of a video
};

void add_render_options(CLI::App& app, RenderRequest* request);

/// What it asks of a picture.
/// @throws lte::Error of one line for flags and keys that would be ignored
RenderSettings settings_of(const RenderRequest& request);

}  // namespace lte::infer
