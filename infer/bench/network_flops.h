// Arithmetic of the network, counted: what its run time is held against.
#pragma once

#include <cstdint>

#include "lte/nn/config.h"
#include "lte/nn/encoder_plan.h"

namespace lte::infer {

/// Floating-point operations, two a multiply-add, of points to latents and the decoder's table:
/// dense layers, convolutions over the pairs there are, attention over the slots of the patches.
/// Sampling, neighbour search, norms and activations count nothing.
/// @param M  scene points of `plan`
double encoder_flops(const nn::ModelConfig& config, const nn::EncoderPlan& plan, int64_t M);

/// The same of one query against m latents, in the factored form (docs/model.md, "Identities"): the
/// least that is known to do. The sums count two multiply-adds a neighbour, layer and channel.
double decoder_flops(const nn::ModelConfig& config, int64_t m);

}  // namespace lte::infer
