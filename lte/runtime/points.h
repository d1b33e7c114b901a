// Borrowed point arrays, so that sampled scenes and baked files go into the network by one door.
#pragma once

#include <cstdint>
#include <span>

#include "lte/base/math.h"

namespace lte::runtime {

/// Scene points, world space; one entry a point in each span.
struct ScenePoints {
  std::span<const Vec3> position, normal;
  std::span<const Rgb> albedo;
  std::span<const Rgb> emission;  ///< W sr^-1 m^-2
  std::span<const float> area;    ///< m²
  /// W/m², of the light that nn::PointSet names; empty unless the model reads it.
  std::span<const Rgb> direct = {}, indirect = {};
  std::span<const Rgb> direct_back = {}, indirect_back = {};
  std::span<const float> indirect_error = {};  ///< two a point: of the front, of the back
  /// Two a point: how metallic and how rough, in [0, 1]. Empty: nothing is metal.
  std::span<const float> gloss = {};

  int64_t size() const { return static_cast<int64_t>(position.size()); }
};

/// Query points, world space.
struct QueryPoints {
  std::span<const Vec3> position, normal;
  std::span<const Rgb> albedo;

  int64_t size() const { return static_cast<int64_t>(position.size()); }
};

/// The values of [N] triples as [3 N] floats.
inline std::span<const float> floats(std::span<const Vec3> triples) {
  static_assert(sizeof(Vec3) == 3 * sizeof(float));
  return {reinterpret_cast<const float*>(triples.data()), 3 * triples.size()};
}

/// Area-weighted mean emission over points and channels, 1 without emission: what irradiance is
/// divided by in training.
/// @throws lte::Error if the arrays differ in length, or there are no scene points.
double mean_emission(const ScenePoints& points);

}  // namespace lte::runtime
