// What lte_render says and refuses because of a scene's size.
#pragma once

#include <string>

#include "lte/pathtrace/bvh.h"
#include "lte/runtime/network.h"

namespace lte::infer {

/// Says in a line of the log if the scene's rooms are so high that its unit cannot be the metre.
/// Nothing is computed by that: it decides what lengths mean, and how far lamps without size reach.
void say_unit(const std::string& name, const pathtrace::Bvh& bvh);

/// Says in a line of the log that the network sees a smaller or larger scene.
/// @throws runtime::SceneTooLarge for a scene wider than the network knows, unless `rescale`.
void check_size(const std::string& name, const scene::Scene& scene, const runtime::Network& network,
                bool rescale);

}  // namespace lte::infer
