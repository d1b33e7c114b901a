// What lte_view does between its command line and its exit code.
#pragma once

#include <cstdint>
#include <string>

#include "infer/tool/tool_options.h"
#include "lte/cli/scene_source.h"
#include "lte/cli/set_keys.h"
#include "lte/render/integrator.h"

namespace lte::infer::view {

/// The command line as it stands. The flags themselves check its words.
struct ViewRequest : SceneSource {
  std::string checkpoint, camera;
  std::string host = "127.0.0.1";
  int port = 8420;
  std::string token;  ///< "auto" for one by chance; empty: none on this machine, else by chance
  std::string size = "640x480";
  int64_t scene_points = 0;  ///< 0: as many as the scene needs
  uint64_t seed = 0;
  bool rescale = true, validate_only = false;
  std::string integrator = "gather";  ///< a word of Method
  int64_t records = render::CacheSettings().records;
  SetKeys keys;
  ToolOptions tool;
};

void add_view_options(CLI::App& app, ViewRequest* request);

/// Serves until it is interrupted.
/// @throws lte::Error for bad input, which open pages are sent, too.
void run_view(const ViewRequest& request);

}  // namespace lte::infer::view
