// TorchScript source of the irradiance cache that queries of `traced` models read.
#pragma once

#include <string>

namespace lte::infer {

/// Lines of encode() that put the cache of nn::make_light_cache() into the embedding.
std::string torchscript_fill_cache();

/// The method cached(embedding, position, normal) -> (irradiance, features) of
/// nn::LightCache::read(), and what it calls besides nearest() of torchscript_ops().
std::string torchscript_read_cache();

}  // namespace lte::infer
