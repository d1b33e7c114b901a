// What a picture of texels needs before engines read it: places without light of their own, and the
// space between charts.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lte/bake/light.h"

namespace lte::bake {

/// Texels of dilation beyond a chart, and of filling behind walls.
inline constexpr int kDilation = 4;

/// The mask of a light map: dark texels are Filled where they lie within kDilation of lit ones of
/// their chart and no front face lies within a texel above them, as behind a wall; else Dark.
/// Pixels within kDilation of a chart are Filled.
std::vector<uint8_t> make_mask(const pathtrace::Bvh& bvh, const Atlas& atlas, const Texels& texels,
                               const TexelLight& light);

/// The same where all dark texels are Dark. @param dark  [texels]
std::vector<uint8_t> make_mask(const Atlas& atlas, const Texels& texels,
                               std::span<const uint8_t> dark);

/// Puts the light of texels into a picture and fills what the mask has as Filled with means of
/// neighbours, those of the own chart first. @param light  [texels] @return  [height, width, 3]
std::vector<float> paint(const Atlas& atlas, const Texels& texels, std::span<const Rgb> light,
                         const std::vector<uint8_t>& mask);

}  // namespace lte::bake
