// What lte_bake computes of a scene and writes, without its command line.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "infer/bake/bake_command.h"
#include "infer/bake/kept_bake.h"
#include "infer/renderer/renderer.h"
#include "lte/bake/formats/formats.h"
#include "lte/bake/lightmap.h"
#include "lte/bake/probes.h"

namespace lte::infer {

struct BakedScene {
  bake::Lightmap map;
  std::optional<bake::ProbeVolume> probes;  ///< where request.probes asks for them
  std::optional<ToKeep> keep;               ///< for a later --since, where request asks for it
  double seam_p99 = 0;                      ///< bake::make_lightmap()
  int shards = 1;                           ///< whose parts in the folder it was joined of
};

/// Lays out and lights the renderer's scene as the request's atlas, light and probes say.
/// Parts are kept in the folder of request.out for a request of a command line alone.
/// @return  nothing under validate_only, with which it stops at the layout, and of a shard
/// @throws lte::Error where nothing shines or light reaches no texel, and as lte/bake does;
///         runtime::NotEnoughMemory before any of it is taken
std::optional<BakedScene> bake_scene(const BakeRequest& request, Renderer* renderer);

/// Writes the files of a format, "gltf" or one of bake::engine_formats(), all or none.
/// @param options  but for probes, which are the baked ones
void write_baked(const BakedScene& baked, const std::string& format, bake::FormatOptions options,
                 const std::filesystem::path& folder);

}  // namespace lte::infer
