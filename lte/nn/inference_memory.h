// Memory of inference: the peak above the weights in MiB, as measured (docs/benchmarks.md), with a
// tenth to spare.
#pragma once

#include <cstdint>

#include "lte/nn/config.h"

namespace lte::nn {

/// To encode M scene points, the embedding included.
double encode_mb(const ModelConfig& config, int64_t M);

/// To decode Q queries in blocks of `block`, the answers included and the queries themselves not.
double decode_mb(const ModelConfig& config, int64_t Q, int64_t block);

}  // namespace lte::nn
