// Paces against a clock that is turned by hand.
#include "infer/picture/ray_pace.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace lte::infer {
namespace {

/// Renders a picture of rows as the renderer does, on a made-up machine.
struct Machine {
  double second_a_ray, second_a_pixel;  ///< direct light; everything else
  double now = 0;

  double render(RayPace* pace, int64_t pixels, int64_t rows, int64_t block) {
    for (int64_t done = 0; done < pixels; done += rows) {
      const int64_t here = std::min(rows, pixels - done);
      pace->begin_rows(here, pixels - done - here);
      now += second_a_pixel * static_cast<double>(here);
      for (int64_t left = here; left > 0; left -= block) {
        const int64_t n = std::min(block, left);
        const int rays = pace->rays(left);
        const double took = second_a_ray * static_cast<double>(n * rays);
        now += took;
        pace->add(n, rays, took);
      }
    }
    return pace->mean_rays();
  }
};

TEST(RayPace, APictureEndsInTimeAndUsesMostOfIt) {
  for (const double budget : {0.4, 1.0, 3.0}) {
    for (const double guess : {0.25e-6, 0.1e-6, 2e-6, 0.0}) {  // the rate measured before
      Machine machine{0.25e-6, 0.5e-6};
      RayPace pace(budget, guess, 1024, [&] { return machine.now; });
      const double rays = machine.render(&pace, 300'000, 200'000, 16'384);
      if (guess == 0.25e-6 || guess == 2e-6) {
        EXPECT_LE(machine.now, budget);
        EXPECT_GT(machine.now, 0.6 * budget);
      }
      EXPECT_GE(rays, 1);
    }
  }
}

TEST(RayPace, ThereIsAlwaysOneRayAndNeverMoreThanTheMost) {
  Machine slow{1e-3, 0};
  RayPace late(0.1, 1e-3, 64, [&] { return slow.now; });
  EXPECT_EQ(slow.render(&late, 1000, 1000, 100), 1);
  EXPECT_TRUE(late.late());
  Machine quick{1e-9, 0};
  RayPace early(10, 1e-9, 48, [&] { return quick.now; });
  EXPECT_EQ(quick.render(&early, 1000, 1000, 100), 48);
  EXPECT_FALSE(early.late());
}

TEST(RayPace, NumbersAreThoseOfWholeStrata) {
  EXPECT_EQ(whole_rays(0.2), 1);
  EXPECT_EQ(whole_rays(7.9), 7);
  EXPECT_EQ(whole_rays(23.5), 16);
  EXPECT_EQ(whole_rays(63), 56);
  EXPECT_EQ(whole_rays(127), 64);
  EXPECT_EQ(whole_rays(130), 128);
}

}  // namespace
}  // namespace lte::infer
