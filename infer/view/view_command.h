// What lte_view does between its command line and its exit code.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "infer/tool/scene_source.h"
#include "infer/tool/tool_options.h"

namespace lte::infer::view {

/// The command line as it stands. The flags themselves check its words.
struct ViewRequest : SceneSource {
  std::string checkpoint, camera;
  std::string host = "127.0.0.1";
  int port = 8420;
  std::string token;  ///< "auto" for one by chance; empty: none on this machine, else by chance
  std::string size = "640x480";
  std::optional<int64_t> scene_points;
  uint64_t seed = 0;
  bool rescale = true, validate_only = false;
  std::string indirect = "gather";        ///< a word of PictureLight
  std::string untrained_light = "trace";  ///< "trace" or "network"
  ToolOptions tool;
};

void add_view_options(CLI::App& app, ViewRequest* request);

/// Serves until it is interrupted.
/// @throws lte::Error for bad input, which pages that are open are told of too.
void run_view(const ViewRequest& request);

}  // namespace lte::infer::view
