// What a kept embedding of a scene was made of.
#pragma once

#include "lte/embed/embed.h"
#include "lte/pathtrace/bvh.h"
#include "lte/runtime/embedding_file.h"
#include "lte/runtime/network.h"

namespace lte::embed {

/// Everything but network and precision that an embedding of embed() depends on: the fingerprint of
/// the scene, and how its points are drawn.
runtime::EmbeddingKey embedding_key(const pathtrace::Bvh& bvh, const runtime::Network& network,
                                    const EmbedSettings& settings);

}  // namespace lte::embed
