// Internal: the side of each chart that light reaches, and where it reaches neither.
#pragma once

#include <vector>

#include "lte/bake/light.h"
#include "lte/bake/texel_sampler.h"
#include "lte/pathtrace/bvh.h"

namespace lte::bake {

/// Turns charts to their back where light reaches only that, or that of a two-sided one is the
/// brighter: their samples become those of the back.
/// @param state  has two passes of the front as its samples; gets `back` and `two_sided`
void choose_sides(const TexelSampler& sampler, const render::Integrator& integrator,
                  const Atlas& atlas, const Texels& texels, LightState* state);

/// Marks texels that light does not reach: those that have found little, by paths. Where none of
/// some texels of a patch is reached, no texel of it is.
/// @param normals  of the sides that are baked
/// @param state    gets `dark`
void find_darkness(const pathtrace::Bvh& bvh, const Atlas& atlas, const Texels& texels,
                   const std::vector<Vec3>& normals, const LightOptions& options,
                   LightState* state);

}  // namespace lte::bake
