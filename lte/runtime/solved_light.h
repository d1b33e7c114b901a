// Light on scene points for models that have it solved (nn::LightInput::Radiosity).
#pragma once

#include "lte/nn/points/point_set.h"

namespace lte::runtime {

/// Whether a model of `config` reads such light and the points are without it.
bool solves_light_of(const nn::PointSet& points, const nn::ModelConfig& config);

/// The points with their direct and indirect irradiance by lte/radiosity, where
/// solves_light_of() them; else as they are. On the device of the points, float32.
/// @param points  that pass nn::check_surfaces()
nn::PointSet with_solved_light(nn::PointSet points, const nn::ModelConfig& config);

}  // namespace lte::runtime
