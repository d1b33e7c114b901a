// Environment points: the environment of a scene as emissive samples of its bounding sphere, for
// the network, which knows light by points alone.
#pragma once

#include <cstdint>

#include "lte/scene/sampler.h"
#include "lte/scene/scene.h"

namespace lte::scene {

/// The sphere around the scene's bounding box.
struct EnvironmentSphere {
  Vec3 center;
  float radius = 0;  ///< metres
};
EnvironmentSphere environment_sphere(const Scene& scene);

/// Appends `count` black points spread evenly over the sphere, with normals inwards. Each has the
/// mean radiance of the environment over its share of the sphere of directions, and 1/count of the
/// sphere's area. Over all points Σ emission · 4π / count is exactly the environment's fluence: no
/// light of a picture is lost, however few the points are.
void append_environment_points(const Scene& scene, int64_t count, SurfaceSamples* samples);

}  // namespace lte::scene
