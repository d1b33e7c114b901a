// At the limits of scene/number_check.h rays are traced, and what they bring is finite.
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/pathtrace/irradiance.h"
#include "lte/pathtrace/render.h"
#include "lte/scene/number_check.h"
#include "tests/support/scenes.h"
#include "tests/support/temp_dir.h"

namespace lte::pathtrace {
namespace {

using ::testing::HasSubstr;

/// A closed room of half width `size` around the origin with a lamp of the given radiance.
scene::Scene room(float size, float radiance) {
  scene::Scene scene;
  const int paint = test::add_material(&scene, {0.5f, 0.5f, 0.5f});
  const int lamp = test::add_material(&scene, {0, 0, 0}, Rgb{1, 1, 1} * radiance);
  test::add_instance(&scene,
                     test::box_mesh({-size, -size, -size}, {size, size, size}, paint, true));
  test::add_quad(&scene, {-size / 2, size / 2, -size / 2}, {size, 0, 0}, {0, 0, size}, lamp);
  return scene;
}

/// Irradiance does not change with the size of a scene, and grows with its radiance.
TEST(ExtremeNumbers, TheLargestAndTheBrightestRoomAreASmallOnesMultiple) {
  IrradianceOptions options;
  options.rays = 256;
  const auto floor = [&](float size, float radiance) {
    const scene::Scene scene = room(size, radiance);
    const Bvh bvh(scene);
    const Lights lights(scene);
    const std::vector<Vec3> at = {{0.3f * size, -size, 0}}, up = {{0, 1, 0}};
    return estimate_irradiance(bvh, lights, at, up, options).total(0).x;
  };
  const float plain = floor(1, 1);
  EXPECT_GT(plain, 0);
  EXPECT_NEAR(floor(scene::kMaxCoordinate, scene::kMaxRadiance) / scene::kMaxRadiance, plain,
              0.1f * plain);
  EXPECT_NEAR(floor(1e-3f, scene::kMaxRadiance) / scene::kMaxRadiance, plain, 0.1f * plain);
}

TEST(ExtremeNumbers, PicturesFromTheCornerOfTheWorldAreFinite) {
  scene::Scene scene = room(scene::kMaxCoordinate, scene::kMaxRadiance);
  test::add_point_light(&scene, {0, 0, 0}, Rgb{1, 1, 1} * scene::kMaxRadiance);
  const Bvh bvh(scene);
  const Lights lights(scene);
  scene::Camera camera;
  camera.origin = Vec3{-0.99f, -0.99f, 0.99f} * scene::kMaxCoordinate;
  camera.target = {0, 0, 0};
  RenderOptions options;
  options.spp = 4;
  const image::Image picture = render_reference(bvh, lights, camera, 8, 8, options);
  for (const float value : picture.pixels) EXPECT_TRUE(std::isfinite(value));
}

/// Embree would end the process.
TEST(ExtremeNumbers, BeyondThemIsAnError) {
  const scene::Scene large = room(2 * scene::kMaxCoordinate, 1);
  EXPECT_THAT(lte::test::error_of([&] { const Bvh bvh(large); }),
              HasSubstr("farther than 1e+09 from the origin"));
  const scene::Scene small = room(1, 1);
  const Bvh bvh(small);
  const Lights lights(small);
  const std::vector<Vec3> far = {{0, 1e30f, 0}}, up = {{0, 1, 0}};
  EXPECT_THAT(lte::test::error_of([&] { estimate_irradiance(bvh, lights, far, up, {}); }),
              HasSubstr("position 0 is farther than 1e+09"));
  scene::Camera camera;
  camera.origin = {0, 0, 1e30f};
  EXPECT_THAT(lte::test::error_of([&] { trace_gbuffer(bvh, camera, 4, 4); }),
              HasSubstr("farther than 1e+09"));
}

/// Its frame is so fine that a ray from the edge of the world would leave Embree's range there.
TEST(ExtremeNumbers, HiddenInstancesAreNotTraced) {
  scene::Scene scene = room(1, 1);
  test::add_instance(&scene, test::box_mesh({-1, -1, -1}, {1, 1, 1}, 0, false),
                     test::scaling({1e-25f, 1e-25f, 1e-25f}));
  const Bvh bvh(scene);
  const Hit hit = bvh.intersect({{0, 0, scene::kMaxCoordinate}, {0, 0, -1}});
  ASSERT_TRUE(hit.valid());
  EXPECT_EQ(hit.instance, 0);
}

}  // namespace
}  // namespace lte::pathtrace
