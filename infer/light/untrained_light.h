// Whether a network meets a kind of light that its training did not have.
#pragma once

#include <span>
#include <string>

#include "lte/nn/model_metadata.h"
#include "lte/scene/sampler.h"
#include "lte/scene/scene.h"

namespace lte::infer {

/// Whether the network is told of a sun or an environment that shines, and has never seen one.
/// Homes with suns have skies, so a network that knows suns knows those.
/// @param left_out  light groups that it is not told of; so in what follows
bool has_untrained_light(const scene::Scene& scene, const nn::ModelMetadata& model,
                         std::span<const int> left_out = {});

/// A line for people who show the scene to such a network; "" if there is no such light.
std::string untrained_light_note(const scene::Scene& scene, const nn::ModelMetadata& model,
                                 std::span<const int> left_out = {});

/// The line for people whose picture gathers traced light instead.
std::string traced_light_note(const scene::Scene& scene, std::span<const int> left_out = {});

/// Takes the points of suns out of the scene points of a network that has never seen one, if other
/// light shines. A sun's point stands for all the power that falls on the scene, of which a room
/// gets little, so beside it the lamps would look darker than any in training. What the sun does
/// indoors such a network knows by the light estimates, if it reads them. By a sun alone it is
/// better told of the light than of none.
void leave_out_untrained_suns(const scene::Scene& scene, const nn::ModelMetadata& model,
                              scene::SurfaceSamples* samples, std::span<const int> left_out = {});

}  // namespace lte::infer
