// What the network costs, counted from its configuration: parameters, arithmetic and memory.
//
// Three readers share it: lte_bench holds run times against the arithmetic, the runtime refuses
// what memory cannot hold, and a dry run of training says what a configuration amounts to.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "lte/nn/config.h"

namespace lte::nn {

class LightTransportModel;  // lte/nn/model.h
struct EncoderPlan;         // lte/nn/encoder/encoder_plan.h

// Parameters

/// Numbers of parameters: in all, and those of F and both G, of PTV3, of the query decoder, and of
/// the radiance decoder.
struct ParameterCounts {
  int64_t total = 0, nne = 0, encoder = 0, decoder = 0, radiance = 0;
};

ParameterCounts count_parameters(const LightTransportModel& model);

/// The same of each module two levels deep, such as "encoder.down3" or "decoder.layer0", in the
/// order of the network.
std::vector<std::pair<std::string, int64_t>> parameters_by_module(const LightTransportModel& model);

// Shapes

/// Latents that M scene points become: two halvings, each rounded up.
int64_t latent_count(int64_t scene_points);

/// Channels of a latent.
int64_t latent_width(const ModelConfig& config);

// Arithmetic, in floating-point operations, two a multiply-add. Dense layers, convolutions over the
// pairs there are, and attention over the slots of the patches count; sampling, neighbour search,
// norms and activations do not.

/// Scene points to latents and the decoder's table.
/// @param M  scene points of `plan`
double encode_flops(const ModelConfig& config, const EncoderPlan& plan, int64_t M);

/// One query against m latents, in the factored form (docs/model.md, "Identities"), which is the
/// least known to do. The sums count two multiply-adds a neighbour, layer and channel.
double decode_flops(const ModelConfig& config, int64_t m);

// Memory of training, in bytes, counted from the layers' shapes.

/// float32 weights, and as much again for each of: gradients, one moment of the optimizer, an
/// average of the weights.
double weight_bytes(int64_t parameters);

/// What the backward pass of one scene keeps, layer by layer, to a third. Fused on a CPU: less.
double activation_bytes(const ModelConfig& config, int64_t M, int64_t Q);

/// Scene points, queries and reference of one scene.
double example_bytes(const ModelConfig& config, int64_t M, int64_t Q);

}  // namespace lte::nn
