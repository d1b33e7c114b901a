// Diffuse light between the points that describe a scene, by radiosity on the points themselves
// (Goral et al. 1984, "Modeling the Interaction of Light Between Diffuse Surfaces"; points as
// elements as in Lehtinen et al. 2008, "A Meshless Hierarchical Representation for Light
// Transport"). No ray is traced and no surface is needed: pieces of planes through the points stand
// for what blocks the view. Coarse, and without noise: a start for a network, which learns what it
// misses.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "lte/base/math.h"

namespace lte::radiosity {

/// Scene points in world space, an entry a point in each span.
struct Points {
  std::span<const Vec3> position, normal;
  std::span<const Rgb> albedo;
  std::span<const Rgb> emission;  ///< W sr^-1 m^-2, towards the side of the normal
  std::span<const float> area;    ///< m² that each point stands for
  /// Light group of each point that emits, −1 for the others; empty: one group.
  std::span<const int32_t> light_group = {};
  /// Direct irradiance of lights that no point stands for, [groups, points] as PointIrradiance has
  /// it: the solution takes it as it is, and reflects it. Empty: there is none.
  std::span<const Rgb> direct = {}, direct_back = {};
};

struct Options {
  /// Points that reflect light to others, chosen from all: time grows with their number.
  int senders = 512;
  /// Reflections that are followed; a room of albedo 0.7 keeps a fourth of its light after 4.
  int bounces = 4;
};

/// Raised by every change after which solve() gives other values: of files that keep solutions.
inline constexpr int kSolverVersion = 4;

/// Irradiance in W/m², [groups, points] each; 0 at points that emit.
struct PointIrradiance {
  std::vector<Rgb> direct, indirect;            ///< on the two sides of the surface together
  std::vector<Rgb> direct_back, indirect_back;  ///< of that, on the side that faces away
};

/// The result does not depend on threads. Points without area or in one place give finite values.
/// @throws lte::Error if the spans differ in length or a light group is not below `groups`
PointIrradiance solve(const Points& points, int64_t groups, const Options& options = {});

}  // namespace lte::radiosity
