// The embedding of a baked scene, of what its file says of the scene points.
#pragma once

#include <vector>

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

/// The same for each luminaire that has scene points by itself, all others out: as light is linear,
/// their answers add up.
std::vector<runtime::SceneEmbedding> embed_by_light(const data::SceneSample& sample,
                                                    const runtime::Network& network,
                                                    const runtime::MemoryLimit& memory);

}  // namespace lte::infer
