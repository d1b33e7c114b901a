// The query decoder as the paper's equations state it: every key, value and position for every pair
// of query and neighbour, no factoring, nothing shared with lte::nn but the parameters.
#pragma once

#include <map>
#include <string>

#include <ATen/core/Tensor.h>

#include "lte/nn/config.h"

namespace lte::test {

/// @param parameters  of a QueryDecoder, by name
/// @param attributes  [Q, 9], @param position [Q, 3] and @param anchor [m, 3] network space, @param
/// latent [m, D]
at::Tensor reference_decoder(const std::map<std::string, at::Tensor>& parameters,
                             const nn::ModelConfig& config, const at::Tensor& attributes,
                             const at::Tensor& position, const at::Tensor& anchor,
                             const at::Tensor& latent, double spacing);

}  // namespace lte::test
