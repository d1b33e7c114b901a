// The light of a bake's layers.
#pragma once

#include <vector>

#include "infer/bake/bake_command.h"
#include "infer/bake/bake_parts.h"
#include "infer/bake/kept_bake.h"
#include "infer/renderer/renderer.h"
#include "lte/bake/bake.h"

namespace lte::infer {

/// A bake that goes on from an earlier one.
struct SinceBake {
  const KeptBake& old;
  const bake::Relayout& relayout;
  bake::Kept kept;  ///< what bake_layers() has found
};

/// One layer of all light, or with --by-light one a light group.
/// @param network  that fills caches; null: paths trace them
/// @param seconds  since the work began, of which --time leaves the rest
/// @param parts    where --resume finds what was sampled, and a --shard leaves it; null: nowhere
/// @param since    null: all is baked
/// @param state    gets the samples of the only layer; may be null
/// @return  nothing of a --shard
std::vector<bake::BakedLayer> bake_layers(const BakeRequest& request,
                                          const runtime::Network* network,
                                          const EmbedSettings& settings, const bake::Layout& layout,
                                          double seconds, const BakeParts* parts, SinceBake* since,
                                          bake::LightState* state, Renderer* renderer);

}  // namespace lte::infer
