// TorchScript source of the point transformer.
#pragma once

#include <string>

#include "lte/nn/config.h"

namespace lte::infer {

/// The method transformer(x: Tensor, cells: Tensor) -> Tensor of nn::PointTransformer, x [m, D] and
/// cells [m, 3] of the serialization grid, and what it calls besides torchscript_ops() and the
/// module's gelu(), norm() and mlp().
std::string torchscript_transformer(const nn::ModelConfig& config);

}  // namespace lte::infer
