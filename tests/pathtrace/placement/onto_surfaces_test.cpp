// Points beside their surface, of which one knows where they belong.
#include "lte/pathtrace/placement/onto_surfaces.h"

#include <gtest/gtest.h>

#include "lte/base/check.h"
#include "lte/pathtrace/irradiance.h"
#include "tests/support/scenes.h"

namespace lte::pathtrace {
namespace {

/// furnished_room() is 4 m wide: what is within 0.4 mm of a surface belongs to it.
class OntoSurfaces : public testing::Test {
 protected:
  scene::Scene scene_ = test::furnished_room();
  Bvh bvh_{scene_};

  Vec3 moved(const Vec3& position, const Vec3& normal, int64_t far) {
    std::vector<Vec3> points = {position};
    EXPECT_EQ(move_onto_surfaces(bvh_, std::vector<Vec3>{normal}, &points), far);
    return points[0];
  }
};

TEST_F(OntoSurfaces, PointsBehindAWallComeOntoIt) {
  EXPECT_NEAR(moved({2, -2e-4f, 1}, {0, 1, 0}, 1).y, 0, 1e-6f);
  EXPECT_NEAR(moved({2, 2.5f + 1e-5f, 2.2f}, {0, -1, 0}, 1).y, 2.5f, 1e-6f);
  EXPECT_NEAR(moved({-3e-4f, 1, 2}, {1, 0, 0}, 1).x, 0, 1e-6f);
  EXPECT_NEAR(moved({1.3f - 2e-4f, 0.5f, 1}, {1, 0, 0}, 1).x, 1.3f, 1e-6f) << "the red box";
}

TEST_F(OntoSurfaces, OthersStay) {
  const Vec3 far = {2, -5e-4f, 1}, in_the_air = {2, 1.5f, 1}, before = {2, 1e-4f, 1},
             under_the_lamp = {1.1f, 2.45f - 1e-6f, 1.1f};
  EXPECT_EQ(moved(far, {0, 1, 0}, 0), far);
  EXPECT_EQ(moved(in_the_air, {0, 1, 0}, 0), in_the_air);
  EXPECT_EQ(moved(before, {0, 1, 0}, 0), before);
  EXPECT_EQ(moved(under_the_lamp, {0, -1, 0}, 0), under_the_lamp);
  const Vec3 on_the_floor = {2, 0, 1};
  EXPECT_NEAR(moved(on_the_floor, {0, 1, 0}, 0).y, 0, 1e-6f);
}

/// 4 µm behind the floor, as a table of six digits may have it, a point was dark.
TEST_F(OntoSurfaces, TheirLightIsThatOfTheSurface) {
  const Lights lights(scene_);
  const std::vector<Vec3> normals(3, Vec3{0, 1, 0});
  std::vector<Vec3> exact = {{2, 0, 1}, {3.5f, 0, 0.5f}, {0.3f, 0, 2.5f}}, behind = exact;
  for (Vec3& p : behind) p.y -= 4e-6f;
  IrradianceOptions options;
  options.rays = 512;
  const Irradiance expected = estimate_irradiance(bvh_, lights, exact, normals, options);
  const Irradiance dark = estimate_irradiance(bvh_, lights, behind, normals, options);
  move_onto_surfaces(bvh_, normals, &behind);
  const Irradiance light = estimate_irradiance(bvh_, lights, behind, normals, options);
  for (int64_t i = 0; i < 3; ++i) {
    EXPECT_LT(dark.total(i).x, 0.01f * expected.total(i).x) << "else the test tells nothing";
    EXPECT_NEAR(light.total(i).x, expected.total(i).x, 0.02f * expected.total(i).x);
  }
}

TEST_F(OntoSurfaces, ANormalAPointIsWanted) {
  std::vector<Vec3> points(2);
  EXPECT_THROW(move_onto_surfaces(bvh_, std::vector<Vec3>(1, Vec3{0, 1, 0}), &points), Error);
}

}  // namespace
}  // namespace lte::pathtrace
