#include "experiments/gathered_base/ray_gather.h"

#include <gtest/gtest.h>

#include "lte/scene/sampler.h"
#include "tests/support/scenes.h"

namespace lte::experiments {
namespace {

/// The gather aims some of its rays at bright places; these follow the cosine alone.
TEST(RayGather, ItsMeansTendToTheGathersOwn) {
  const scene::Scene scene = test::hall_of_lamps();
  const pathtrace::Bvh bvh(scene);
  const pathtrace::Lights lights(scene);
  const gi::CacheRecords records = gi::sample_records(bvh, 200, 1);
  const gi::RecordLight light = gi::estimate_records(bvh, lights, records, 4, 2, 2);
  const gi::IrradianceCache cache(bvh, records, light.total(), light.direct);
  const scene::SurfaceSamples points = scene::sample_surface(scene, 100, {.seed = 5});
  const std::span<const Vec3> position(points.position.data(), 100),
      normal(points.normal.data(), 100);
  gi::GatherOptions options;
  options.rays = 512;
  options.seed = 3;
  const RayGather rays = gather_rays(bvh, lights, cache, position, normal, options);
  const gi::Gathered whole = gi::gather_irradiance(bvh, lights, cache, position, normal, options);
  Rgb own{}, gathered{};
  for (const Rgb& value : rays.value) own += value / 512;
  for (const Rgb& value : whole.indirect) gathered += value;
  EXPECT_GT(gathered.x, 0);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(own[c], gathered[c], 0.01f * gathered[c]);
}

/// From the middle of the floor of a closed box of side 2 nothing is nearer than the walls, and
/// nothing farther than the corners of the ceiling.
TEST(RayGather, MeasuresTheFirstRays) {
  scene::Scene scene;
  const int wall = test::add_material(&scene, {0.5f, 0.5f, 0.5f}, {1, 1, 1});
  test::add_instance(&scene, test::box_mesh({-1, -1, -1}, {1, 1, 1}, wall, true));
  const pathtrace::Bvh bvh(scene);
  const std::vector<Vec3> position{{0, -1, 0}}, normal{{0, 1, 0}};
  gi::GatherOptions options;
  options.rays = 256;
  const RayGather rays = gather_rays(bvh, pathtrace::Lights(scene),
                                     gi::IrradianceCache(bvh, {}, {}), position, normal, options);
  const auto [least, most] = std::minmax_element(rays.distance.begin(), rays.distance.end());
  EXPECT_GE(*least, 0.999f);
  EXPECT_LE(*most, std::sqrt(6.0f) * 1.001f);
  EXPECT_GT(*most, 2);
}

}  // namespace
}  // namespace lte::experiments
