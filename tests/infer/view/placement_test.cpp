#include <cmath>

#include <gtest/gtest.h>

#include "infer/view/scene_description.h"

namespace lte::infer::view {
namespace {

void expect_near(const Vec3& a, const Vec3& b, float tolerance = 1e-5f) {
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(a[axis], b[axis], tolerance) << axis;
}

TEST(Placement, TurnsCounterClockwiseFromAboveAboutTheFoot) {
  const Vec3 foot{2, 1, 3};
  const Affine quarter = placed({{}, 90, 1}, foot);
  expect_near(quarter.point(foot), foot);
  // From above, with x to the right and z towards the viewer, counter-clockwise is +x to -z.
  expect_near(quarter.point({3, 1, 3}), {2, 1, 2});
  expect_near(quarter.point({2, 5, 3}), {2, 5, 3});
}

TEST(Placement, ScalesFromTheFootAndThenMoves) {
  const Affine twice = placed({{10, 0, -1}, 0, 2}, {2, 1, 3});
  expect_near(twice.point({2, 1, 3}), {12, 1, 2});
  expect_near(twice.point({3, 2, 3}), {14, 3, 2});
}

TEST(Placement, IsReadBackFromTransforms) {
  Affine loaded;  // turned about x, mirrored and moved, as files have it
  loaded.m = {{{-1, 0, 0, 4}, {0, 0.6f, -0.8f, 1}, {0, 0.8f, 0.6f, -2}}};
  const Vec3 foot{3.5f, 0, -2.5f};
  for (const Placement& placement : {Placement{{0.5f, 0, -0.25f}, 30, 1},
                                     Placement{{0, 1, 0}, -170, 0.5f}, Placement{{}, 180, 3}}) {
    const Placement back = placement_of(loaded, placed(placement, foot) * loaded, foot);
    expect_near(back.move, placement.move, 1e-4f);
    EXPECT_NEAR(back.scale, placement.scale, 1e-5f);
    EXPECT_NEAR(std::remainder(back.turn - placement.turn, 360.0f), 0, 1e-3f);
  }
  EXPECT_EQ(placement_of(loaded, loaded, foot), Placement());
}

}  // namespace
}  // namespace lte::infer::view
