// The shipped network's light does not hang on how a modeller left the sides of surfaces: against
// paths in the same room.
#include <utility>

#include <gtest/gtest.h>

#include "infer/renderer/renderer.h"
#include "lte/cli/assets.h"
#include "lte/pathtrace/irradiance.h"
#include "lte/pathtrace/reach/reach.h"
#include "tests/support/scenes.h"

namespace lte::infer {
namespace {

/// A panel under the ceiling that shines down; one that hangs and shines up and down, as a sheet
/// that emits from both sides, or as two that emit from one.
enum class Lamp { Flush, TwoSided, BackToBack };

/// How a room is modelled.
struct Sides {
  unsigned windings = 0;  ///< a bit a mesh that is wound the other way
  bool double_sided = false;
  Lamp lamp = Lamp::Flush;
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
  const bool hangs = sides.lamp != Lamp::Flush;
  const Rgb radiance = Rgb{16, 14, 11} * (hangs ? 0.5f : 1.0f);
  const int lamp =
      test::add_material(&scene, {0.5f, 0.5f, 0.5f}, radiance, sides.lamp == Lamp::TwoSided);
  const Vec3 x{0.8f, 0, 0}, z{0, 0, 0.7f};
  test::add_quad(&scene, {1.7f, hangs ? 1.9f : 2.58f, 1.4f}, x, z, lamp);
  if (sides.lamp == Lamp::BackToBack) test::add_quad(&scene, {1.7f, 1.902f, 1.4f}, z, x, lamp);
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
  // Lamps that hang in a room are not among those that the network has learnt from; that half of
  // their light were missing would show.
  const double two_sided = ratio(network, {0, false, Lamp::TwoSided});
  EXPECT_NEAR(two_sided, 1, 0.2);
  EXPECT_NEAR(two_sided, ratio(network, {0, false, Lamp::BackToBack}), 0.05);
}

}  // namespace
}  // namespace lte::infer
