// The dial: what a quality, a flag and a time budget come to.
#include "infer/render/quality.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "infer/render/time_budget.h"
#include "lte/base/check.h"
#include "tests/infer/fixture.h"

namespace lte::infer {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(Quality, TimesAreSecondsOrMilliseconds) {
  EXPECT_DOUBLE_EQ(parse_time_budget("0.5s"), 0.5);
  EXPECT_DOUBLE_EQ(parse_time_budget("200ms"), 0.2);
  EXPECT_DOUBLE_EQ(parse_time_budget("1e1s"), 10);
  for (const char* wrong : {"", "0.5", "s", "-1s", "0s", "nans", "infs", "1 s", "1min", "1sx"}) {
    EXPECT_THAT([&] { parse_time_budget(wrong); },
                ThrowsMessage<Error>(HasSubstr("such as 0.5s or 200ms")))
        << wrong;
  }
}

TEST(Quality, FlagsByHandWinAndFinalIsThePictureOfAlways) {
  const RenderSettings base;
  const RenderSettings last = with_quality(Quality::Final, Sparse::Auto, {}, base);
  EXPECT_EQ(last.direct_samples, base.direct_samples);
  EXPECT_EQ(last.antialias, base.antialias);
  EXPECT_FALSE(last.sparse.has_value());
  const RenderSettings draft = with_quality(Quality::Draft, Sparse::Auto, {}, base);
  const RenderSettings preview = with_quality(Quality::Preview, Sparse::Auto, {}, base);
  EXPECT_LT(draft.direct_samples, preview.direct_samples);
  EXPECT_LT(preview.direct_samples, last.direct_samples);
  EXPECT_LT(draft.antialias, preview.antialias);
  EXPECT_LT(preview.antialias, last.antialias);
  ASSERT_TRUE(draft.sparse && preview.sparse);
  EXPECT_GE(draft.sparse->tolerance, preview.sparse->tolerance);
  RenderSettings mine = base;
  mine.direct_samples = 7;
  mine.antialias = 3;
  const RenderSettings by_hand =
      with_quality(Quality::Draft, Sparse::Off, {true, true, true}, mine);
  EXPECT_EQ(by_hand.direct_samples, 7);
  EXPECT_EQ(by_hand.antialias, 3);
  EXPECT_FALSE(by_hand.sparse.has_value());
  EXPECT_TRUE(with_quality(Quality::Final, Sparse::On, {}, base).sparse.has_value());
  mine.mode = Mode::Reference;
  EXPECT_FALSE(with_quality(Quality::Draft, Sparse::Auto, {}, mine).sparse.has_value());
}

std::array<QualitySettings, 3> three() {
  return {quality_settings(Quality::Draft), quality_settings(Quality::Preview),
          quality_settings(Quality::Final)};
}

TEST(Quality, TheBestThatFitsIsTaken) {
  // A machine of 1 µs a hit, 10 µs an answer, 0.2 µs a ray; 100,000 pixels.
  const PictureRates rates{1e-6, 10e-6, 0.2e-6, 0};
  constexpr int64_t kPixels = 100'000;
  double before = 0;
  for (const Quality quality : {Quality::Draft, Quality::Preview, Quality::Final}) {
    const double need = predicted_seconds(quality_settings(quality), rates, kPixels);
    EXPECT_GT(need, before);
    before = need;
    EXPECT_EQ(choose_quality(1.001 * need, 0, rates, kPixels, three(), false), quality);
  }
  // Final: 3.4 hits, one answer, 64 rays a pixel, and a slack of 15 %.
  EXPECT_NEAR(before, 1.15 * kPixels * (3.4e-6 + 10e-6 + 12.8e-6), 1e-9);
}

TEST(Quality, ATimeThatNothingFitsIntoIsRefusedWithTheOneThatWould) {
  const PictureRates rates{1e-6, 10e-6, 0.2e-6, 0};
  // Draft with one ray: 1 + 0.5 + 0.2 µs a pixel.
  const double least = 1.15 * 100'000 * 1.7e-6;
  EXPECT_EQ(choose_quality(1.01 * least, 0, rates, 100'000, three(), false), Quality::Draft);
  EXPECT_THAT([&] { choose_quality(0.99 * least, 0.4, rates, 100'000, three(), false); },
              ThrowsMessage<Error>(AllOf(HasSubstr("--time-budget"), HasSubstr("0.19 s are left"),
                                         HasSubstr("expected 0.60 s or more"),
                                         testing::Not(HasSubstr("\n")))));
  // Rays that were given by hand are not taken away.
  EXPECT_THROW(choose_quality(1.01 * least, 0, rates, 100'000, three(), true), Error);
  EXPECT_THAT([] { check_time_left(0.2, 0.3111); },
              ThrowsMessage<Error>(HasSubstr("--time-budget 0.2s: scene points and encoding took "
                                             "312 ms")));
  EXPECT_NO_THROW(check_time_left(0.2, 0.1));
}

TEST(Quality, APlanOfALongBudgetIsFinalAndHasAPaceUnlessRaysAreGiven) {
  const scene::Scene scene = test::lit_floor();
  Renderer renderer(scene);
  const test::TempDir folder;
  test::save_tiny_model(folder / "tiny.safetensors");
  renderer.embed(runtime::Network(folder / "tiny.safetensors"), {});
  RenderSettings base;
  base.width = 32;
  base.height = 24;
  const Timer clock;
  const PicturePlan plan =
      plan_picture(3600, clock, Sparse::Auto, {}, base, test::downward_camera(), &renderer);
  EXPECT_EQ(plan.quality, Quality::Final);
  ASSERT_NE(plan.pace, nullptr);
  EXPECT_EQ(plan.settings.pace, plan.pace.get());
  renderer.render(test::downward_camera(), plan.settings);
  EXPECT_EQ(plan.pace->mean_rays(), 256) << "an hour is enough for the most";
  const PicturePlan fixed = plan_picture(3600, clock, Sparse::Auto, {true, false, false}, base,
                                         test::downward_camera(), &renderer);
  EXPECT_EQ(fixed.pace, nullptr);
  EXPECT_EQ(fixed.settings.direct_samples, base.direct_samples);
}

}  // namespace
}  // namespace lte::infer
