// What a network begins with, without the network: the light on its scene points, interpolated.
#pragma once

#include <vector>

#include "infer/light/points.h"
#include "lte/runtime/embedding.h"

namespace lte::infer {

/// Indirect irradiance in W/m² as the network's light cache (nn::LightCache) reads it: path-traced
/// estimates, or a radiosity solution, between the scene points. It is what the network's answer is
/// a factor on. Empty for a network without such a cache.
std::vector<Rgb> cached_light(const runtime::SceneEmbedding& embedding, const QueryPoints& queries);

}  // namespace lte::infer
