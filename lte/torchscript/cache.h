// TorchScript source of what models read of the light on scene points: columns of theirs, and the
// irradiance cache that queries of `traced` models read.
#pragma once

#include <cstdint>
#include <string>

#include "lte/nn/config.h"

namespace lte::torchscript {

/// Columns of `points` up to the area; those of light follow, three a kind.
inline constexpr int64_t kPointColumns = 13;

/// Columns of light: irradiance of both sides, that of the back, and errors, as `config` reads
/// them.
int64_t light_columns(const nn::ModelConfig& config);
/// Their names in the message about a wrong shape: ", direct irradiance" or the like.
std::string light_column_names(const nn::ModelConfig& config);

/// Lines of encode() that join to x what F reads of light.
std::string read_light_source(const nn::ModelConfig& config);

/// Lines of encode() that put the cache of nn::make_light_cache() into the embedding.
std::string fill_cache_source(const nn::ModelConfig& config);

/// The method cached(embedding, position, normal) -> (irradiance, features) of
/// nn::LightCache::read(), and what it calls besides nearest() of ops_source().
std::string read_cache_source(const nn::ModelConfig& config);

}  // namespace lte::torchscript
