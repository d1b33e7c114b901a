// TorchScript source of the light on scene points: their columns, and the light prior at queries.
#pragma once

#include <cstdint>
#include <string>

#include "lte/nn/config.h"

namespace lte::torchscript {

/// Columns of `points` up to the area; those of light follow.
inline constexpr int64_t kPointColumns = 13;

/// Columns of light, of models that read any: direct and indirect irradiance of both sides, the
/// same of the back, and for estimates errors of front and back.
int64_t light_columns(const nn::ModelConfig& config);
/// Their names in the message about a wrong shape.
std::string light_column_names(const nn::ModelConfig& config);

/// Lines of encode() that join the columns of F for light to x.
std::string read_light_source(const nn::ModelConfig& config);

/// Lines of encode() that put nn::make_light_prior() into the embedding.
std::string fill_cache_source(const nn::ModelConfig& config);

/// The method cached(embedding, position, normal) -> (irradiance, features) of
/// nn::LightPrior::read(), and what it calls besides nearest() of ops_source().
std::string read_cache_source(const nn::ModelConfig& config);

}  // namespace lte::torchscript
