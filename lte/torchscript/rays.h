// TorchScript source of the rays that radiance decoders cast among the scene points: what
// lte/nn/points/surfels.h and lte/ops/surfel_walk.h do, with built-in operators alone and without a
// grid.
#pragma once

#include <string>

#include "lte/nn/config.h"

namespace lte::torchscript {

/// Lines of encode() that put the discs of nn::make_surfels() into the embedding, behind those of
/// fill_cache_source(). Empty for models that cast no rays.
std::string make_surfels_source(const nn::ModelConfig& config);

/// The method seen(embedding, position, directions) of nn::Surfels::see(), and what it calls. Each
/// ray is held against every disc, some 10^6 pairs at a time. Empty for models that cast no rays.
std::string rays_source(const nn::ModelConfig& config);

}  // namespace lte::torchscript
