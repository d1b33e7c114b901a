#include "experiments/attention/closest_point.h"

#include <cmath>

#include <gtest/gtest.h>

#include "lte/base/check.h"
#include "lte/base/random.h"
#include "tests/support/scenes.h"

namespace lte::experiments {
namespace {

TEST(ClosestPoint, IsThatOfManyPointsOfTheSurface) {
  const scene::Scene scene = test::furnished_room();
  Rng rng(5);
  for (int trial = 0; trial < 20; ++trial) {
    const Vec3 place{rng.uniform(-1, 5), rng.uniform(-1, 4), rng.uniform(-1, 5)};
    const ClosestPoint found = closest_point(scene, place);
    EXPECT_NEAR(length(found.surface.position - place), found.distance, 1e-4f);
    float least = INFINITY;
    for (size_t i = 0; i < scene.instances.size(); ++i) {
      const scene::Mesh& mesh = scene.meshes[static_cast<size_t>(scene.instances[i].mesh)];
      for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        for (int sample = 0; sample < 400; ++sample) {
          float u = rng.uniform(), v = rng.uniform();
          if (u + v > 1) {
            u = 1 - u;
            v = 1 - v;
          }
          const scene::Surface s = scene::evaluate_surface(scene, static_cast<int>(i), t, u, v, 0);
          least = std::min(least, length(s.position - place));
        }
      }
    }
    EXPECT_LE(found.distance, least + 1e-4f) << "no sampled point is nearer";
    EXPECT_GT(found.distance, least - 0.35f) << "and some come near";
  }
}

TEST(ClosestPoint, FacesThePlace) {
  const scene::Scene scene = test::furnished_room();
  const ClosestPoint inside = closest_point(scene, {1, 1.2f, 1.9f});
  EXPECT_GE(dot(Vec3{1, 1.2f, 1.9f} - inside.surface.position, inside.surface.normal), 0);
  const Vec3 below = {1, -0.5f, 2};
  const ClosestPoint under = closest_point(scene, below);
  EXPECT_GE(dot(below - under.surface.position, under.surface.normal), 0);
}

TEST(ClosestPoint, RefusesWhatHasNone) {
  EXPECT_THROW(closest_point(scene::Scene{}, {0, 0, 0}), Error);
  EXPECT_THROW(closest_point(test::furnished_room(), {NAN, 0, 0}), Error);
}

}  // namespace
}  // namespace lte::experiments
