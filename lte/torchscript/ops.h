// TorchScript source of the operators that the exported network calls: thin calls of
// torch.ops.lte.*, or the same written with built-in operators alone.
#pragma once

#include <string>

namespace lte::torchscript {

/// Methods of the exported module: farthest_points, nearest, curve_codes, convolution_pairs,
/// submanifold_conv, neighbour_table, neighbour_sums. Their contracts are those of lte/ops; both
/// variants agree to rounding.
/// @param portable  built-in operators alone, so that the module loads where lte is not
std::string ops_source(bool portable);

}  // namespace lte::torchscript
