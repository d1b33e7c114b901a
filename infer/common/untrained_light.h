// Whether a network meets a kind of light that its training did not have.
#pragma once

#include <string>

#include "lte/nn/model_metadata.h"
#include "lte/scene/scene.h"

namespace lte::infer {

/// A line for people who show the scene to a network that has never seen a sun; "" if it has none,
/// or the network has seen some.
std::string untrained_light_note(const scene::Scene& scene, const nn::ModelMetadata& model);

}  // namespace lte::infer
