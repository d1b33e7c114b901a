// Sides of surfaces in scenes of a generator, as modellers leave them: lamps that shine from both,
// walls and furniture wound either way.
#pragma once

#include <cstdint>

#include "datagen/common/range.h"
#include "lte/scene/scene.h"

namespace lte::datagen {

/// `sides:` in the YAML config.
struct SideConfig {
  /// Of ceiling lights: hung below the ceiling, shining from both sides, a third of them as narrow
  /// strips.
  double two_sided_share = 0;
  Range drop_m{0.04, 0.6};  ///< from the ceiling, log-uniform
  /// Of meshes that do not emit: wound the other way, which changes no light.
  double flipped_share = 0;
};

/// @note The draws are the seed's alone: the scene is otherwise the one that it is without.
void vary_sides(const SideConfig& config, uint64_t seed, scene::Scene* scene);

}  // namespace lte::datagen
