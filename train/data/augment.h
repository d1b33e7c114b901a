// Exact symmetries of light transport: new training examples without new rendering
// (docs/training.md).
//
// Irradiance is a functional of geometry, albedo and emission that commutes with rigid motions and
// reflections of space (only distances and angles enter), with permutations of the color channels
// (each is transported by itself), and is linear in the emission of each luminaire. So applying one
// draw to scene points, queries and reference alike gives another true example.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lte/base/math.h"
#include "lte/base/random.h"
#include "train/config.h"

namespace lte::train {

/// One element of the symmetry group. The default is the identity for a scene without luminaires.
struct Symmetry {
  std::array<Vec3, 3> rotation = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};  ///< its rows
  bool mirror = false;                      ///< x -> −x before the rotation
  std::array<int, 3> channels = {0, 1, 2};  ///< where each channel of the result comes from
  std::vector<Rgb> gains;                   ///< [G], of each luminaire, before the permutation

  /// Maps positions and normals alike: the map is linear and orthogonal.
  Vec3 space(Vec3 v) const {
    if (mirror) v.x = -v.x;
    return {dot(rotation[0], v), dot(rotation[1], v), dot(rotation[2], v)};
  }
  Rgb color(const Rgb& c) const { return {c[channels[0]], c[channels[1]], c[channels[2]]}; }
  /// Maps emission or irradiance of light group `group`; −1 (no luminaire) has unit gain.
  Rgb light(const Rgb& c, int32_t group) const {
    return color(group < 0 ? c : c * gains[static_cast<size_t>(group)]);
  }
};

Symmetry identity_symmetry(int64_t light_groups);

/// Draws what `config` switches on. A rotation by which `bounds` would outgrow `largest_extent`
/// (the network's cube of side s) is replaced by the nearest quarter turn, which never does.
Symmetry draw_symmetry(const AugmentConfig& config, int64_t light_groups, const Bounds& bounds,
                       double largest_extent, Rng* rng);

}  // namespace lte::train
