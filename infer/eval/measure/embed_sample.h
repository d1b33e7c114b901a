// The embedding of a baked scene, of what its file says of the scene points.
#pragma once

#include "lte/data/scene_sample.h"
#include "lte/runtime/embedding.h"

namespace lte::infer {

/// @throws lte::Error if the sample lacks light that the model reads, or as SceneEmbedding
runtime::SceneEmbedding embed_sample(const data::SceneSample& sample,
                                     const runtime::Network& network,
                                     const runtime::MemoryLimit& memory);

}  // namespace lte::infer
