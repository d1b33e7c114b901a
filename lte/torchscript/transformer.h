// TorchScript source of the point transformer.
#pragma once

#include <string>

#include "lte/nn/config.h"

namespace lte::torchscript {

/// The method transformer(x: Tensor, cells: Tensor) -> Tensor of nn::PointTransformer, x [m, D] and
/// cells [m, 3] of the serialization grid, and what it calls besides ops_source() and the
/// module's gelu(), norm() and mlp().
std::string transformer_source(const nn::ModelConfig& config);

}  // namespace lte::torchscript
