// TorchScript source of the query decoder.
#pragma once

#include <string>

#include "lte/nn/config.h"

namespace lte::infer {

/// The methods decode(embedding, queries) and what it calls besides torchscript_ops() and the
/// module's norm(), mlp(), gelu() and attributes(): nn::LightTransportModel::decode().
std::string torchscript_decoder(const nn::ModelConfig& config);

}  // namespace lte::infer
