// What lte_bake does between its command line and its exit code.
#pragma once

#include <filesystem>
#include <string>

#include "infer/renderer/light_request.h"
#include "lte/bake/atlas.h"
#include "lte/bake/formats/formats.h"
#include "lte/bake/light.h"

namespace lte::infer {

/// The command line as it stands.
struct BakeRequest : LightRequest {
  BakeRequest() { records = 0; }  ///< bake::record_count()

  std::string out;
  std::string quality = "preview", include = "full", format = "gltf";
  std::string time;  ///< empty: as long as `quality` takes
  double error = 0;  ///< relative, of indirect light; 0: none
  bool by_light = false;
  bake::AtlasOptions atlas;
  bake::FormatOptions files;  ///< but for probes
  std::string probes;         ///< "", auto or NXxNYxNZ
  bool resume = false;
  bool keep_samples = false;  ///< leave what a later --since goes on with
  std::string since;          ///< folder of a bake of the scene before it changed; empty: none
  double change = 0.02;       ///< bake::RebakeOptions::tolerance
  std::string shard;          ///< "2/4"; empty: the whole bake
  double keep_every = 10;     ///< seconds
};

void add_bake_options(CLI::App& app, BakeRequest* request);

/// Loads, bakes, writes the folder, and prints a line.
/// @throws lte::Error for bad input, also for flags that would be ignored.
void run_bake(const BakeRequest& request);

}  // namespace lte::infer
