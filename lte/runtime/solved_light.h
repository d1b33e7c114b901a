// Light on scene points for models that have it solved (nn::LightInput::Radiosity).
#pragma once

#include "lte/nn/point_set.h"

namespace lte::runtime {

/// The points with their direct and indirect irradiance by lte/radiosity, if a model of `config`
/// reads those and they are not given; else as they are. On the device of the points, float32.
/// Rows that encode() would refuse are left to it.
nn::PointSet with_solved_light(nn::PointSet points, const nn::ModelConfig& config);

}  // namespace lte::runtime
