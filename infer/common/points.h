// Borrowed point arrays, so that sampled scenes and baked files go into the network by one door.
#pragma once

#include <cstdint>
#include <span>

#include "lte/base/math.h"

namespace lte::infer {

/// Scene points, world space; one entry a point in each span.
struct ScenePoints {
  std::span<const Vec3> position, normal;
  std::span<const Rgb> albedo;
  std::span<const Rgb> emission;  ///< W sr^-1 m^-2
  std::span<const float> area;    ///< m²
  /// W/m², nn::PointSet says of which light; empty unless the model reads it.
  std::span<const Rgb> direct = {}, indirect = {};

  int64_t size() const { return static_cast<int64_t>(position.size()); }
};

/// Query points, world space.
struct QueryPoints {
  std::span<const Vec3> position, normal;
  std::span<const Rgb> albedo;

  int64_t size() const { return static_cast<int64_t>(position.size()); }
  QueryPoints slice(int64_t begin, int64_t count) const {
    const auto b = static_cast<size_t>(begin), n = static_cast<size_t>(count);
    return {position.subspan(b, n), normal.subspan(b, n), albedo.subspan(b, n)};
  }
};

/// The values of [N] triples as [3 N] floats.
inline std::span<const float> floats(std::span<const Vec3> triples) {
  static_assert(sizeof(Vec3) == 3 * sizeof(float));
  return {reinterpret_cast<const float*>(triples.data()), 3 * triples.size()};
}

}  // namespace lte::infer
