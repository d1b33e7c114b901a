// Weights of a network for one that is some times as wide.
#pragma once

#include <cstdint>
#include <string>

#include <ATen/core/Tensor.h>

#include "lte/nn/config.h"

namespace lte::train {

/// How many times as wide as `file`'s network the model's is; 1 where that is no whole number, or
/// where heads would be of another width, as a network of fewer channels than a head has narrower
/// ones.
int64_t widening(const nn::ModelConfig& model, const nn::ModelConfig& file);

/// A parameter of the wider network, with which that answers as the narrow one does, to rounding:
/// every channel is there `factor` times, so that normalizations see the same means, and what reads
/// copies takes a share of each (Chen et al. 2016, "Net2Net"). The shares differ at random, and add
/// up to the weight; so copies get different gradients and part ways.
///
/// Draws from torch's generator.
///
/// @param name    of the parameter, which tells where queries, keys and values are side by side
/// @param values  the narrow network's, float32: [out], [out, in] or [taps, in, out]
/// @param shape   of the wider network's; each axis as long as in `values`, or `factor` times
/// @return        of `shape`
at::Tensor widened(const std::string& name, const at::Tensor& values, at::IntArrayRef shape,
                   int64_t factor);

}  // namespace lte::train
