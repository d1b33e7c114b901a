// Internal: the side of each chart that light reaches, and where it reaches neither.
#pragma once

#include <vector>

#include "lte/bake/light.h"
#include "lte/bake/texel_sampler.h"
#include "lte/pathtrace/bvh.h"

namespace lte::bake {

/// Texels that decide the side of their chart: some of each.
std::vector<uint32_t> deciding_texels(const Texels& texels, int32_t charts);

/// The side of each chart that light reaches; the brighter one of two-sided charts lit on both.
/// @param which    texels with two passes of the front in `samples`: the deciding ones at least.
///                 Charts without any are not looked at, and not turned.
Sides choose_sides(const TexelSampler& sampler, const render::Integrator& integrator,
                   const Atlas& atlas, const Texels& texels, std::span<const uint32_t> which,
                   const TexelSamples& samples);

/// Puts two passes of the back in the place of those of the front, where charts are turned.
void sample_turned(const TexelSampler& sampler, const render::Integrator& integrator,
                   const Texels& texels, const std::vector<uint8_t>& back, TexelSamples* samples);

/// Marks texels that light does not reach: wide patches whose samples have found none, and of
/// others that have found little those that paths do not reach. Where none of some texels of a
/// patch is reached, no texel of it is.
/// @param state  has samples and sides, and gets `dark`
void find_darkness(const pathtrace::Bvh& bvh, const Atlas& atlas, const Texels& texels,
                   const LightOptions& options, LightState* state);

}  // namespace lte::bake
