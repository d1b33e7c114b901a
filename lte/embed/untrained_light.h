// Whether a network meets a kind of light that its training did not have.
#pragma once

#include <span>
#include <string>

#include "lte/runtime/network.h"
#include "lte/scene/sampler.h"
#include "lte/scene/scene.h"

namespace lte::embed {

/// Whether a sun or an environment shines that the network reads and has never seen in training.
/// Homes with suns have skies, so a network that knows suns knows those.
/// @param culled  light groups that it does not read; so in what follows
bool has_untrained_light(const scene::Scene& scene, const runtime::ModelMetadata& model,
                         std::span<const int> culled = {});

/// A line for people who show the scene to such a network; "" if there is no such light.
std::string untrained_light_note(const scene::Scene& scene, const runtime::ModelMetadata& model,
                                 std::span<const int> culled = {});

/// The line for people whose picture gathers traced light instead.
std::string traced_light_note(const scene::Scene& scene, std::span<const int> culled = {});

/// Takes the points of suns out of the scene points of a network that has never seen one, if other
/// light shines. A sun's point stands for all the power that falls on the scene, of which a room
/// gets little, so beside it the lamps would look darker than any in training. What the sun does
/// indoors such a network knows by the light estimates, if it reads them. A sun that shines alone
/// stays: light of the wrong strength is better than none.
void drop_untrained_suns(const scene::Scene& scene, const runtime::ModelMetadata& model,
                         scene::SurfaceSamples* samples, std::span<const int> culled = {});

}  // namespace lte::embed
