// The texels of an atlas: what part of which triangles lies in each.
//
// Every texel that a triangle touches counts (conservative rasterization), since bilinear look-ups
// read it. Its light is that of the part inside the triangle, never of a place beyond an edge.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "lte/bake/atlas.h"
#include "lte/base/math.h"

namespace lte::bake {

/// A triangle's part of a texel.
struct Fragment {
  int32_t instance = 0;
  uint32_t triangle = 0;
  float area = 0;             ///< of a texel, (0, 1]
  uint32_t first_corner = 0;  ///< of that part, in Texels::corners
  uint32_t corners = 0;
};

/// Texels that charts cover, in the order of blocks of 8 x 8 pixels: neighbours have neighbouring
/// numbers. Every array has an entry a texel, but `fragments`.
struct Texels {
  std::vector<uint32_t> pixel;  ///< y * width + x
  std::vector<uint32_t> first;  ///< [texels + 1]: its first fragment, and their end
  std::vector<Fragment> fragments;
  std::vector<Vec2> corners;  ///< barycentric, as scene::evaluate_surface() has them
  std::vector<int32_t> chart;
  std::vector<Vec3> position, normal;  ///< means over the fragments: world, unit, front side
  std::vector<float> edge;             ///< metres that a texel is wide there

  size_t size() const { return pixel.size(); }
  /// The convex part of its triangle that lies in the texel.
  std::span<const Vec2> part_of(const Fragment& fragment) const {
    return std::span(corners).subspan(fragment.first_corner, fragment.corners);
  }
};

/// @throws lte::Error where no triangle touches a texel
Texels find_texels(const Atlas& atlas);

/// A place inside each texel's part of its triangles, by area. `u` [3] in [0, 1) chooses it.
struct TexelPlace {
  Vec3 position, normal;  ///< world, unit, front side
};
TexelPlace place_in(const Atlas& atlas, const Texels& texels, size_t texel,
                    const std::array<float, 3>& u);

}  // namespace lte::bake
