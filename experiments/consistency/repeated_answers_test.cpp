// Answers at points that are asked repeatedly, and the cameras of the frames.
#include <cmath>

#include <gtest/gtest.h>

#include "experiments/consistency/consistency.h"
#include "tests/support/scenes.h"

namespace lte::experiments {
namespace {

TEST(RepeatedAnswers, AreHeldAgainstTheFirstAtTheirPoint) {
  RepeatedAnswers answers(3);
  answers.add(std::vector<size_t>{0, 2}, std::vector<Rgb>{{1, 2, 3}, {4, 5, 6}});
  EXPECT_EQ(answers.compared(), 0);
  answers.add(std::vector<size_t>{2, 1}, std::vector<Rgb>{{4, 5, 6}, {9, 9, 9}});
  EXPECT_EQ(answers.compared(), 1);
  EXPECT_EQ(answers.largest_change(), 0);
  answers.add(std::vector<size_t>{0}, std::vector<Rgb>{{1, 2.25f, 2.5f}});
  EXPECT_EQ(answers.largest_change(), 0.5);
  answers.add(std::vector<size_t>{1}, std::vector<Rgb>{{NAN, 9, 9}});
  EXPECT_TRUE(std::isnan(answers.largest_change()));
}

TEST(Consistency, CamerasTurnBySmallEvenSteps) {
  const scene::Scene scene = test::furnished_room();
  const pathtrace::Bvh bvh(scene);
  ConsistencyOptions options;
  options.frames = 5;
  options.degrees = 30;
  const scene::Camera first{"inside", {2, 1.6f, 2.8f}, {2, 1, 0}, {0, 1, 0}, 70};
  const auto cameras = consistency_cameras(bvh, first, options);
  ASSERT_EQ(cameras.size(), 5u);
  const auto ahead = [](const scene::Camera& c) {  // about the vertical
    return normalize(Vec3{c.target.x - c.origin.x, 0, c.target.z - c.origin.z});
  };
  for (size_t i = 0; i + 1 < cameras.size(); ++i) {
    EXPECT_NEAR(std::acos(dot(ahead(cameras[i]), ahead(cameras[i + 1]))), 6 * kPi / 180, 1e-3);
    EXPECT_EQ(cameras[i].origin, cameras[0].origin) << "within a room";
  }
}

}  // namespace
}  // namespace lte::experiments
