// Light points: lights that are no surface as emissive samples for the network, which knows light
// by points alone. Point and spot lights stand in their places, suns (directional lights) and the
// environment on the sphere around the scene.
#pragma once

#include <cstdint>

#include "lte/scene/sampler.h"
#include "lte/scene/scene.h"

namespace lte::scene {

/// How many of a scene's points stand for lights that are no surface.
struct LightPointCounts {
  /// Two for each point light and one for each spot light; one for each of either where that would
  /// be more than half of all points.
  int64_t local = 0;
  int64_t suns = 0;         ///< one for each directional light that shines
  int64_t environment = 0;  ///< SamplerOptions::environment_share of all points

  int64_t total() const { return local + suns + environment; }
};

LightPointCounts light_point_counts(const Scene& scene, int64_t count,
                                    const SamplerOptions& options);

/// The solid angle in sr that a sun's point takes among `count` points: that of a point of the
/// environment, 4π over the number that an environment would get.
double sun_solid_angle(int64_t count, const SamplerOptions& options);

/// Appends the light points of a scene that has `count` points in all: point and spot lights, suns,
/// the environment. All are black.
///
/// A point light is two discs of area `area` back to back, one facing up and one down, or the lower
/// one alone where there are too many lights for two; a spot light one that faces along it.
/// Emission · area · π, summed over the discs, is the power. Neither tells a direction as the light
/// has it: networks that solve light are given the direct light of both where there are triangles.
///
/// A sun of irradiance E is a patch of the sphere where its light comes from, as the environment
/// has them: of solid angle Ω = sun_solid_angle() seen from the middle, so of area Ω r² and
/// radiance E/Ω, its normal along the light. A patch of sky of irradiance E would be the same
/// sample there.
void append_light_points(const Scene& scene, int64_t count, float area,
                         const SamplerOptions& options, SurfaceSamples* samples);

/// World bounds of everything that scene points lie on: the surfaces, the sphere of a scene with an
/// environment, and the suns' places on it.
Bounds point_bounds(const Scene& scene);

}  // namespace lte::scene
