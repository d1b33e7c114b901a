// Paces of gathered pictures against a clock that is turned by hand.
#include "infer/renderer/picture_pace.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

namespace lte::infer {
namespace {

/// Makes pictures as the renderer does, on a made-up machine.
struct Machine {
  double gather_s = 0.5e-6, shadow_s = 0.15e-6, path_s = 1.5e-6, finish_s = 2e-6;
  double before_s = 0.4e-6, after_s = 0.6e-6;  // a pixel: first hits; denoising and edges
  int64_t pixels = 307'200, rough = 60'000;
  int step = 2;
  double slow_at = 1e9;  // from then on everything takes twice as long
  double now = 0;
  int passes = 0;

  void spend(double seconds) { now += now >= slow_at ? 2 * seconds : seconds; }

  /// What a plan would say that knows the machine but for a factor.
  PaceSettings plan(double budget, bool paths, double wrong) const {
    PaceSettings out;
    const double count = static_cast<double>(pixels);
    out.budget_s = budget;
    out.paths = paths;
    out.base_s = paths ? 0.5 * budget / count : budget / count;
    out.after_rays_s = wrong * after_s;
    out.gather_s = wrong * gather_s;
    out.shadow_s = wrong * shadow_s;
    out.path_s = wrong * path_s;
    out.finish_s = wrong * finish_s;
    out.least = 0.25;
    out.most = 3;
    return out;
  }

  void render(PicturePace* pace, const LightRays& wanted, int strips = 1) {
    for (int strip = 0; strip < strips; ++strip) {
      const int64_t here = pixels / strips;
      const auto count = static_cast<double>(here);
      pace->begin_rows(here, here * (strips - strip - 1));
      spend(before_s * count);
      const int64_t points = here / (step * step);
      for (int64_t left = points; left > 0; left -= 8192) {
        const LightRays rays = pace->rays(wanted, left);
        const int64_t n = std::min<int64_t>(left, 8192);
        LightWork work{n, gather_s * static_cast<double>(n * rays.gather),
                       shadow_s * static_cast<double>(n * rays.shadow)};
        spend(work.gather_seconds + work.direct_seconds);
        if (now >= slow_at) work = {n, 2 * work.gather_seconds, 2 * work.direct_seconds};
        pace->add_rays(rays, work);
      }
      spend(after_s * count);
      const int64_t few = rough / strips;
      pace->begin_paths(few, here - few);
      bool smooths = false;
      for (PixelPass pass = pace->next_pass(); !pass.empty(); pass = pace->next_pass()) {
        spend(2 * path_s *
              (static_cast<double>(few) * pass.rough +
               static_cast<double>(here - few) * pass.smooth));
        smooths |= pass.smooth > 0;
        pace->add_pass(pass);
        ++passes;
      }
      spend(finish_s * count * (smooths ? 1 : PicturePace::kRoughFinish));
    }
  }
};

TEST(PicturePace, TimeIsUsedAndNotOverrunWhateverWasExpected) {
  for (const double budget : {1.0, 2.0, 5.0, 10.0, 30.0, 120.0}) {
    for (const double wrong : {0.7, 1.0, 1.5}) {
      for (const int strips : {1, 3}) {
        Machine machine;
        PicturePace pace(machine.plan(budget, true, wrong), [&] { return machine.now; });
        machine.render(&pace, {8, 8}, strips);
        EXPECT_LE(machine.now, 1.05 * budget) << wrong << " " << strips;
        EXPECT_GE(machine.now, (budget < 2 ? 0.6 : 0.8) * budget) << wrong << " " << strips;
        EXPECT_TRUE(machine.passes > 0 || budget < 2) << budget;
        EXPECT_LT(machine.passes, 40 * strips) << "each has a cost of its own";
      }
    }
  }
}

TEST(PicturePace, WithoutPathsRaysTakeTheTime) {
  for (const double budget : {0.75, 1.0, 1.25}) {
    for (const double wrong : {0.8, 1.0, 1.2}) {
      Machine machine;
      PicturePace pace(machine.plan(budget, false, wrong), [&] { return machine.now; });
      machine.finish_s = 0;
      machine.render(&pace, {8, 8});
      EXPECT_LE(machine.now, 1.05 * budget) << wrong;
      EXPECT_GE(machine.now, 0.85 * budget) << wrong;
      EXPECT_EQ(machine.passes, 0);
      EXPECT_GE(pace.mean_gather_rays(), 6);
      EXPECT_NEAR(pace.mean_gather_rays(), pace.mean_shadow_rays(), 1e-9);
    }
  }
}

TEST(PicturePace, AMachineThatBecomesSlowGetsFewerRaysAndPaths) {
  for (const double slow_at : {0.2, 0.4, 0.8, 1.5, 4.0}) {
    for (const double budget : {1.0, 2.0, 5.0, 10.0}) {
      Machine machine;
      PicturePace pace(machine.plan(budget, budget > 1, 1), [&] { return machine.now; });
      if (budget == 1.0) machine.finish_s = 0;
      machine.slow_at = slow_at;
      machine.render(&pace, {8, 8});
      EXPECT_LE(machine.now, 1.3 * budget) << slow_at;
      EXPECT_GE(pace.mean_gather_rays(), 2);
    }
  }
}

TEST(PicturePace, EdgesComeFirstAndNothingIsTracedWithoutTime) {
  PaceSettings settings;
  settings.budget_s = 1;
  settings.path_s = 1e-6;
  double now = 0;
  PicturePace pace(settings, [&] { return now; });
  pace.begin_rows(100'000, 0);
  pace.begin_paths(20'000, 80'000);
  const PixelPass few = pace.next_pass();
  EXPECT_EQ(few.smooth, 0) << "2 s for those that smooth pixels begin with";
  EXPECT_EQ(few.rough, 5);
  now = 0.9;
  EXPECT_EQ(pace.next_pass().smooth, 0);
  EXPECT_EQ(pace.next_pass().rough, 1);
  now = 0.97;
  EXPECT_TRUE(pace.next_pass().empty());
  now = 1.5;
  EXPECT_TRUE(pace.next_pass().empty());
  now = -1e6;  // all the time there is
  PixelPass sum;
  for (PixelPass pass = pace.next_pass(); !pass.empty(); pass = pace.next_pass()) {
    sum.rough += pass.rough;
    now += 1e-3;
    pace.add_pass(pass);
  }
  EXPECT_GT(sum.rough, 10'000);
  EXPECT_LE(sum.rough, 1 << 14);
  const LightRays late = pace.rays({8, 0}, 1000);
  EXPECT_EQ(late.gather, 8) << "no rate, no pace";
}

TEST(PicturePace, SmoothPixelsFollowEdgesAndBeginWithEnough) {
  PaceSettings settings;
  settings.budget_s = 100;
  settings.path_s = 1e-6;
  settings.rough_first = 16;
  double now = 0;
  PicturePace pace(settings, [&] { return now; });
  pace.begin_rows(100'000, 0);
  pace.begin_paths(20'000, 80'000);
  PixelPass sum;
  std::vector<PixelPass> passes;
  for (PixelPass pass = pace.next_pass(); !pass.empty(); pass = pace.next_pass()) {
    // Paths of smooth pixels take three times as long as those of edges.
    now += 2e-6 * (20'000.0 * pass.rough + 3 * 80'000.0 * pass.smooth);
    pace.add_pass(pass);
    if (sum.smooth == 0 && pass.smooth > 0) {
      EXPECT_GE(sum.rough, 16);
      EXPECT_EQ(pass.smooth, 5);
    }
    sum.rough += pass.rough;
    sum.smooth += pass.smooth;
  }
  EXPECT_GT(sum.smooth, 5);
  EXPECT_LE(now, 100);
  EXPECT_GT(now, 85);
}

}  // namespace
}  // namespace lte::infer
