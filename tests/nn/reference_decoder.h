// The query decoder as the paper's equations state it: every key, value and position for every pair
// of query and neighbour, no factoring, nothing shared with lte::nn but the parameters.
#pragma once

#include <map>
#include <string>

#include <ATen/core/Tensor.h>

#include "lte/nn/config.h"
#include "lte/nn/decoder/query_decoder.h"

namespace lte::test {

/// @param parameters  of a QueryDecoder, by name
/// @param attributes  [Q, 9], @param query of Q points and @param anchor of m in network space,
/// normals only for a configuration that reads them, @param latent [m, D]
at::Tensor reference_decoder(const std::map<std::string, at::Tensor>& parameters,
                             const nn::ModelConfig& config, const at::Tensor& attributes,
                             const nn::Surface& query, const nn::Surface& anchor,
                             const at::Tensor& latent, double spacing);

}  // namespace lte::test
