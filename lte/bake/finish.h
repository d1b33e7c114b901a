// What a picture of texels needs before engines read it: places without light of their own, the
// space between charts, and charts that meet along an edge of the surface.
#pragma once

#include <cstdint>
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

/// Puts the light of texels into a picture and fills what the mask has as Filled with means of
/// neighbours, those of the own chart first. @return [height, width, 3]
std::vector<float> paint(const Atlas& atlas, const Texels& texels, const TexelLight& light,
                         const std::vector<uint8_t>& mask);

/// A place on an edge that two charts share, by what bilinear look-ups read of either.
struct SeamPlace {
  std::array<uint32_t, 8> pixel{};
  std::array<float, 8> weight{};  ///< negative for the second chart: the difference is the sum
};

/// Edges of triangles that meet smoothly in the world and not in the atlas.
std::vector<SeamPlace> find_seams(const Atlas& atlas, const std::vector<uint8_t>& mask);

/// Changes texels by least squares so that both sides of a seam look up the same light (Iwanicki,
/// "Lighting technology of The Last of Us", 2013).
void join_seams(const std::vector<SeamPlace>& seams, const std::vector<uint8_t>& mask,
                std::vector<float>* irradiance);

/// Of the differences across seams over the light there (a hundredth of the mean light at least),
/// the value that a share of them is below.
double seam_difference(const std::vector<SeamPlace>& seams, const std::vector<float>& irradiance,
                       double share);

}  // namespace lte::bake
