// TorchScript source of the radiance decoder.
#pragma once

#include <string>

#include "lte/nn/config.h"

namespace lte::infer {

/// The method radiance(embedding, queries, directions) -> Tensor of
/// nn::LightTransportModel::decode_radiance(), and what it calls besides the methods of
/// torchscript_decoder.h and torchscript_rays.h. Empty for models without a radiance decoder.
std::string torchscript_radiance(const nn::ModelConfig& config);

}  // namespace lte::infer
