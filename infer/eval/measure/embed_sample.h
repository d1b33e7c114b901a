// The embedding of a baked scene, from the scene points of its file.
#pragma once

#include "lte/data/scene_sample.h"
#include "lte/runtime/embedding.h"

namespace lte::infer {

/// Leaves `count` of the sample's scene points, or where that is 0 as many as the model was trained
/// on, as a renderer would show it.
void thin_for(const runtime::Network& network, int64_t count, data::SceneSample* sample);

/// @throws lte::Error if the sample lacks light that the model reads, or as SceneEmbedding
runtime::SceneEmbedding embed_sample(const data::SceneSample& sample,
                                     const runtime::Network& network,
                                     const runtime::MemoryLimit& memory);

}  // namespace lte::infer
