// Rough metals in scenes of a generator: the paper's glossy subset (supplement, section 1).
#pragma once

#include <cstdint>

#include "datagen/common/range.h"
#include "lte/scene/scene.h"

namespace lte::datagen {

/// `metals:` in the YAML config.
struct MetalConfig {
  double share = 0;            ///< of the materials that do not emit; 0: none
  Range roughness{0.05, 0.5};  ///< of a metal, log-uniform
};

/// Turns materials of a scene into metals, at least one of them if `share` is above 0. A plain
/// color becomes that of a metal; a texture stays, as brushed or painted metal has one.
/// @note The draws are the seed's alone: the scene is the one that it is without metals.
void add_metals(const MetalConfig& config, uint64_t seed, scene::Scene* scene);

}  // namespace lte::datagen
