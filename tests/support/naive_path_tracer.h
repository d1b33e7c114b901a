// A path tracer that a reader can check at a glance, and that shares no code with lte's: paths by
// cosine sampling alone find light by hitting it or by leaving the scene.
#pragma once

#include <cmath>

#include "lte/base/random.h"
#include "lte/pathtrace/bvh.h"
#include "lte/scene/surface.h"

namespace lte::test {

/// A cosine-distributed unit direction around a unit normal.
inline Vec3 naive_direction(const Vec3& normal, Rng& rng) {
  Vec3 tangent, bitangent;
  make_frame(normal, &tangent, &bitangent);
  const float r = std::sqrt(rng.uniform()), phi = 2 * kPi * rng.uniform();
  return tangent * (r * std::cos(phi)) + bitangent * (r * std::sin(phi)) +
         normal * std::sqrt(1 - r * r);
}

/// Radiance along a path: emission counts at every hit, from the sides that emit.
inline Rgb naive_radiance(const pathtrace::Bvh& bvh, Vec3 origin, Vec3 direction, int max_depth,
                          Rng& rng) {
  Rgb throughput{1, 1, 1}, sum;
  for (int depth = 1; depth <= max_depth; ++depth) {
    const pathtrace::Hit hit = bvh.intersect({origin, direction, 1e-4f});
    if (!hit.valid()) {
      if (const auto& sky = bvh.scene().environment)
        sum += throughput * sky->radiance_from(direction);
      break;
    }
    const scene::Surface surface =
        scene::evaluate_surface(bvh.scene(), hit.instance, hit.triangle, hit.u, hit.v, 0);
    const bool front = dot(surface.normal, direction) < 0;
    if (front || surface.emits_back) sum += throughput * surface.emission;
    throughput *= surface.albedo;
    origin = surface.position;
    direction = naive_direction(front ? surface.normal : -surface.normal, rng);
  }
  return sum;
}

struct NaiveIrradiance {
  double mean[3] = {};
  double variance[3] = {};  ///< of the mean
};

inline NaiveIrradiance naive_irradiance(const pathtrace::Bvh& bvh, const Vec3& position,
                                        const Vec3& normal, int max_depth, int paths, Rng rng) {
  double sum[3] = {}, squares[3] = {};
  for (int path = 0; path < paths; ++path) {
    const Vec3 direction = naive_direction(normal, rng);
    const Rgb value = naive_radiance(bvh, position, direction, max_depth, rng) * kPi;
    for (int c = 0; c < 3; ++c) {
      sum[c] += double{value[c]};
      squares[c] += double{value[c]} * double{value[c]};
    }
  }
  NaiveIrradiance out;
  for (int c = 0; c < 3; ++c) {
    out.mean[c] = sum[c] / paths;
    out.variance[c] = (squares[c] / paths - out.mean[c] * out.mean[c]) / paths;
  }
  return out;
}

}  // namespace lte::test
