// Charts that meet along an edge of the surface must look up the same light there.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lte/bake/atlas.h"

namespace lte::bake {

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
