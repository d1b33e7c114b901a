// TorchScript source of the query decoders: that of irradiance, and that of the radiance decoder.
#pragma once

#include <cstdint>
#include <string>

#include "lte/nn/config.h"

namespace lte::torchscript {

/// Queries decoded at a time: keeps the pairs with their neighbours within some 100 MB.
inline constexpr int64_t kQueryRows = 4096;

/// The method decode(embedding, queries) of nn::LightTransportModel::decode(), and what it calls
/// besides ops_source() and the module's norm(), mlp(), gelu() and attributes(). Models that
/// predict radiance have gather_radiance(embedding, queries) too: features [Q, D], light [Q, 3].
std::string decoder_source(const nn::ModelConfig& config);

/// Lines of encode() that put the tables of all decoders into the embedding.
std::string tables_source(const nn::ModelConfig& config);

}  // namespace lte::torchscript
