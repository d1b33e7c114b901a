// The shipped network's light does not hang on how a modeller left the sides of surfaces: against
// paths in the same room.
#include <utility>

#include <gtest/gtest.h>

#include "infer/renderer/renderer.h"
#include "infer/tool/assets.h"
#include "lte/pathtrace/irradiance.h"
#include "lte/pathtrace/reach/reach.h"
#include "tests/support/scenes.h"

namespace lte::infer {
namespace {

/// How a room is modelled.
struct Sides {
  unsigned windings = 0;  ///< a bit a mesh that is wound the other way
  bool double_sided = false;
  bool hanging = false;  ///< the lamp hangs in the middle and shines from both sides
};

/// A room with two boxes. Its lamp has the same power however it shines.
scene::Scene room(const Sides& sides) {
  scene::Scene scene;
  scene.name = "room";
  const int white = test::add_material(&scene, {0.75f, 0.72f, 0.7f}, {}, sides.double_sided);
  const int red = test::add_material(&scene, {0.6f, 0.2f, 0.15f}, {}, sides.double_sided);
  test::add_instance(&scene, test::box_mesh({0, 0, 0}, {4.2f, 2.6f, 3.6f}, white, true));
  test::add_instance(&scene, test::box_mesh({0.4f, 0, 0.3f}, {1.4f, 0.8f, 1.1f}, red, false));
  test::add_instance(&scene, test::box_mesh({2.9f, 0, 2.2f}, {3.8f, 1.7f, 3}, white, false));
  for (size_t m = 0; m < scene.meshes.size(); ++m) {
    if ((sides.windings >> m & 1) == 0) continue;
    for (auto& triangle : scene.meshes[m].triangles) std::swap(triangle[1], triangle[2]);
  }
  const Rgb radiance = Rgb{16, 14, 11} * (sides.hanging ? 0.5f : 1.0f);
  const int lamp = test::add_material(&scene, {0.5f, 0.5f, 0.5f}, radiance, sides.hanging);
  test::add_quad(&scene, {1.7f, sides.hanging ? 1.9f : 2.58f, 1.4f}, {0.8f, 0, 0}, {0, 0, 0.7f},
                 lamp);
  return scene;
}

double sum(const std::vector<Rgb>& light) {
  double total = 0;
  for (const Rgb& value : light) total += double{value.x} + value.y + value.z;
  return total;
}

/// The mean of the network's indirect light over that of paths, where light reaches.
double ratio(const runtime::Network& network, const Sides& sides) {
  const scene::Scene scene = room(sides);
  Renderer renderer(scene);
  EmbedSettings settings;
  settings.scene_points = 4096;
  renderer.embed(network, settings);
  pathtrace::PruneCounts counts;
  const scene::SurfaceSamples queries = pathtrace::sample_reached_surface(
      renderer.bvh(), 1500, {.seed = 9}, pathtrace::Purpose::Queries, {}, &counts);
  const double answered =
      sum(renderer.embedding().decode({queries.position, queries.normal, queries.albedo}));
  const pathtrace::Irradiance truth = pathtrace::estimate_irradiance(
      renderer.bvh(), renderer.lights(), queries.position, queries.normal, {.rays = 64});
  return answered / sum(truth.indirect);
}

TEST(SidesOfSurfaces, TheNetworksLightIsThatOfEveryWindingAndOfLampsThatShineFromBoth) {
  const runtime::Network network(checkpoint_or_shipped(""));
  const double plain = ratio(network, {});
  EXPECT_NEAR(plain, 1, 0.1);
  for (const unsigned windings : {7u, 2u}) {
    for (const bool double_sided : {false, true}) {
      EXPECT_NEAR(ratio(network, {windings, double_sided}), plain, 0.05)
          << "windings " << windings << ", double-sided " << double_sided;
    }
  }
  EXPECT_NEAR(ratio(network, {.hanging = true}), plain, 0.05);
}

}  // namespace
}  // namespace lte::infer
