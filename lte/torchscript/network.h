// TorchScript source of the network of lte/nn for one configuration.
#pragma once

#include <string>

#include "lte/nn/config.h"

namespace lte::torchscript {

/// The attribute that holds a parameter: "encoder.down0.1.mlp.hidden.weight" ->
/// "encoder_down0_1_mlp_hidden_weight".
std::string attribute_of(const std::string& parameter);

/// Methods of the exported module besides those of ops_source():
///
///     encode(points: Tensor) -> Dict[str, Tensor]
///         points [M, 13]: position, normal, albedo, emission, area; of models that read light
///         then direct and indirect irradiance, and that of the back of each [M, 25]; of those
///         that read estimates, the errors of front and back [M, 27]; of those that predict
///         radiance, metallic and roughness. Models whose light is solved take points without
///         columns of light, too. The order of the points counts for nothing.
///     decode(embedding: Dict[str, Tensor], queries: Tensor) -> Tensor
///         queries [Q, 9]: position, normal, albedo; result [Q, 3] irradiance, W/m²
///     forward(points: Tensor, queries: Tensor) -> Tensor
///
/// Positions are in world space; dtype and units are those of nn::PointSet, float32. The embedding
/// has position [m, 3], features [m, D], table, origin [3], spacing [] and radiance [3], which is
/// nn::Embedding::emission_scale.
std::string network_source(const nn::ModelConfig& config);

}  // namespace lte::torchscript
