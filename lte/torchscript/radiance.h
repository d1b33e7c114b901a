// TorchScript source of the radiance decoder.
#pragma once

#include <string>

#include "lte/nn/config.h"

namespace lte::torchscript {

/// The method radiance(embedding, queries, directions) -> Tensor of
/// nn::LightTransportModel::decode_radiance(), and what it calls besides the methods of
/// decoder_source.h and rays_source.h. Empty for models without a radiance decoder.
std::string radiance_source(const nn::ModelConfig& config);

}  // namespace lte::torchscript
