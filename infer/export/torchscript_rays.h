// TorchScript source of the rays that radiance decoders cast among the scene points: what
// lte/nn/surfels.h and lte/ops/surfel_walk.h do, with built-in operators alone and without a grid.
#pragma once

#include <string>

#include "lte/nn/config.h"

namespace lte::infer {

/// Lines of encode() that put the discs of nn::make_surfels() into the embedding, behind those of
/// torchscript_fill_cache(). Empty for models that cast no rays.
std::string torchscript_make_surfels(const nn::ModelConfig& config);

/// The method seen(embedding, position, directions) of nn::Surfels::see(), and what it calls. Each
/// ray is held against every disc, some 10^6 pairs at a time. Empty for models that cast no rays.
std::string torchscript_rays(const nn::ModelConfig& config);

}  // namespace lte::infer
