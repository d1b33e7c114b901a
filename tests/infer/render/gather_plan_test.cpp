// The dial of gathered light: which flag asks for it, and what a time comes to.
#include "infer/render/gather_plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "infer/render/gather_flags.h"
#include "lte/base/check.h"
#include "tests/infer/fixture.h"
#include "tests/support/scenes.h"

namespace lte::infer {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

RenderSettings base() {
  RenderSettings out;
  out.indirect = Indirect::Gather;
  out.denoise = Denoise::Auto;
  out.width = 640;
  out.height = 480;
  return out;
}

const GatherRates kRates{0.2e-6, 0.3e-6, 0.5e-6, 1.5e-6, 1e-6, 2e-6, 0};

double base_seconds(RenderSettings settings) {
  settings.correction_paths = 0;
  return predicted_gather_seconds(settings, kRates);
}

TEST(GatherPlan, QualitiesTakeLongerFromStepToStep) {
  const std::vector<GatherRung> ladder = gather_ladder(Sparse::Auto, {}, base());
  double before = 0;
  for (const GatherRung& rung : ladder) {
    const double now = base_seconds(rung.settings);
    EXPECT_GT(now, before) << enum_name(rung.quality);
    const GatherChoice choice = choose_rung(1.001 * now, 0, kRates, ladder, {});
    const bool final = rung.quality == Quality::Final;
    EXPECT_EQ(choice.rung.quality, final ? Quality::Preview : rung.quality);
    EXPECT_TRUE(final || choice.rung.settings.gather.step == rung.settings.gather.step);
    EXPECT_TRUE(choice.paced);
    EXPECT_FALSE(rung.settings.sparse.has_value()) << "the network's quadtree is not meant";
    before = now;
  }
  EXPECT_EQ(ladder.back().quality, Quality::Final);
  EXPECT_EQ(ladder.back().settings.gather.step, 1);
  EXPECT_GT(ladder.back().settings.correction_paths, 0) << "final has no floor";
}

TEST(GatherPlan, TimeBeyondAPictureIsForPaths) {
  const std::vector<GatherRung> ladder = gather_ladder(Sparse::Auto, {}, base());
  const GatherRung& preview = ladder[ladder.size() - 2];
  const double preview_s = base_seconds(preview.settings);
  const double pixels = 640 * 480;
  for (const double factor : {4.0, 8.0, 16.0, 64.0}) {
    const GatherChoice choice = choose_rung(factor * preview_s, 0, kRates, ladder, {});
    EXPECT_EQ(choice.rung.quality, Quality::Preview) << "paths find more than Final's rays";
    EXPECT_EQ(choice.rung.settings.gather.rays, preview.settings.gather.rays);
    EXPECT_GT(choice.rung.settings.correction_paths, 0);
    EXPECT_TRUE(choice.pace.paths);
    EXPECT_GT(choice.pace.rough_first, 0);
    EXPECT_LE(pixels * choice.pace.base_s, 0.65 * factor * preview_s);
    EXPECT_LT(choice.pace.after_rays_s, choice.pace.base_s);
    EXPECT_EQ(choice.pace.path_s, kRates.path_s);
  }
  // Rays become more before that; where nothing else fits they have all of the time.
  const double least = base_seconds(ladder.front().settings);
  const GatherChoice quick = choose_rung(1.05 * least, 0, kRates, ladder, {});
  EXPECT_FALSE(quick.pace.paths);
  EXPECT_EQ(quick.rung.settings.correction_paths, 0) << "so both lights are denoised at once";
  EXPECT_NEAR(pixels * quick.pace.base_s, 1.05 * least, 1e-9);
  EXPECT_GT(quick.pace.most, 1);
  EXPECT_LT(quick.pace.least, 1);
  GivenFlags given;
  given.gather_rays = true;
  EXPECT_EQ(choose_rung(1.5 * least, 0, kRates, ladder, given).pace.most, 1);
}

TEST(GatherPlan, CountsByHandAreKept) {
  const std::vector<GatherRung> ladder = gather_ladder(Sparse::Auto, {}, base());
  const double final_s = predicted_gather_seconds(ladder.back().settings, kRates);
  GivenFlags given;
  given.correction_paths = true;
  const GatherChoice choice = choose_rung(8 * final_s, 0, kRates, ladder, given);
  EXPECT_EQ(choice.rung.settings.correction_paths, ladder.back().settings.correction_paths);
  // Paths of irradiance alone are counted ahead.
  RenderSettings light = base();
  light.output = Output::Irradiance;
  const GatherChoice ahead =
      choose_rung(8 * final_s, 0, kRates, gather_ladder(Sparse::Auto, {}, light), {});
  EXPECT_FALSE(ahead.paced);
  EXPECT_GT(ahead.rung.settings.correction_paths, 8);
  EXPECT_EQ(ahead.rung.settings.correction_paths % 2, 0);
  EXPECT_LE(predicted_gather_seconds(ahead.rung.settings, kRates), 8 * final_s);
  EXPECT_GT(predicted_gather_seconds(ahead.rung.settings, kRates), 0.9 * 8 * final_s);
}

TEST(GatherPlan, TooLittleTimeIsRefusedInOneLine) {
  const std::vector<GatherRung> ladder = gather_ladder(Sparse::Auto, {}, base());
  const double least = base_seconds(ladder.front().settings);
  EXPECT_THAT([&] { choose_rung(0.9 * least, 0.4, kRates, ladder, {}); },
              ThrowsMessage<Error>(AllOf(HasSubstr("--time-budget"), HasSubstr("expected"),
                                         testing::Not(HasSubstr("\n")))));
}

TEST(GatherPlan, FlagsByHandWin) {
  RenderSettings mine = base();
  mine.gather = {5, 1};
  mine.correction_paths = 6;
  mine.direct_samples = 7;
  mine.antialias = 3;
  const RenderSettings draft =
      with_quality(Quality::Draft, Sparse::Off, {true, true, true, true, true}, mine);
  EXPECT_EQ(draft.gather.rays, 5);
  EXPECT_EQ(draft.gather.step, 1);
  EXPECT_EQ(draft.correction_paths, 6);
  EXPECT_GT(with_quality(Quality::Final, Sparse::On, {}, mine).gather.step, 1);
  RenderSettings large = base();
  large.width = large.height = 1024;
  EXPECT_EQ(with_quality(Quality::Draft, Sparse::Auto, {}, large).gather.step, 2);
  large.width = 1025;
  EXPECT_EQ(with_quality(Quality::Draft, Sparse::Auto, {}, large).gather.step, 4);
  EXPECT_EQ(with_quality(Quality::Draft, Sparse::Auto, {}, large).gather.rays, 6);
  EXPECT_EQ(with_quality(Quality::Draft, Sparse::Auto, {}, large).direct_samples, 6);
  EXPECT_EQ(with_quality(Quality::Draft, Sparse::Auto, {.gather_rays = true}, large).gather.rays,
            base().gather.rays);
  EXPECT_EQ(with_quality(Quality::Preview, Sparse::Auto, {}, large).gather.step, 2);
  EXPECT_EQ(with_quality(Quality::Preview, Sparse::Auto, {}, large).gather.rays, 16);
  EXPECT_EQ(with_quality(Quality::Final, Sparse::On, {}, large).gather.rays, 32);
  EXPECT_FALSE(draft.gather.direct) << "shadow rays by hand are for every pixel";
  EXPECT_TRUE(with_quality(Quality::Draft, Sparse::Auto, {}, mine).gather.direct);
  EXPECT_FALSE(with_quality(Quality::Final, Sparse::Auto, {}, mine).gather.direct);
}

TEST(GatherPlan, AQualityCorrectsGatheredLightAlone) {
  RenderSettings settings = base();
  EXPECT_EQ(with_quality(Quality::Final, Sparse::Auto, {}, settings).correction_paths, 8);
  settings.indirect = Indirect::Decoded;
  EXPECT_EQ(with_quality(Quality::Final, Sparse::Auto, {}, settings).correction_paths, 0);
  settings.correction_paths = 6;
  const GivenFlags given{.correction_paths = true};
  EXPECT_EQ(with_quality(Quality::Final, Sparse::Auto, given, settings).correction_paths, 6);
}

TEST(GatherPlan, APictureOfALongBudgetHasMorePathsThanFinal) {
  const scene::Scene scene = test::furnished_room();
  Renderer renderer(scene);
  renderer.make_table({});
  RenderSettings settings = base();
  settings.width = 24;
  settings.height = 16;
  const scene::Camera camera{"in", {3.8f, 1.2f, 0.2f}, {0, 1, 0.2f}, {0, 1, 0}, 70};
  const Timer clock;
  const PicturePlan plan = plan_gathered(1.5, clock, Sparse::Auto, {}, settings, camera, &renderer);
  EXPECT_EQ(plan.quality, Quality::Preview);
  EXPECT_EQ(plan.pace, nullptr);
  ASSERT_NE(plan.gather_pace, nullptr);
  EXPECT_EQ(plan.settings.gather.pace, plan.gather_pace.get());
  EXPECT_GT(renderer.render(camera, plan.settings).correction_paths,
            quality_settings(Quality::Final).correction_paths);
  EXPECT_THAT([&] { plan_gathered(1e-9, clock, Sparse::Auto, {}, settings, camera, &renderer); },
              ThrowsMessage<Error>(HasSubstr("--table-points")));
}

struct Parsed {
  explicit Parsed(const std::string& line, bool neural = true) {
    CLI::App app;
    std::string ignored;
    for (const char* flag : {"--quality", "--time-budget", "--checkpoint", "--embedding",
                             "--save-embedding", "--scene-points", "--prune", "--draws"})
      app.add_option(flag, ignored);
    add_gather_options(app, &flags);
    app.parse(line);
    check_gather_flags(app, flags, neural, /*attention=*/false);
  }
  GatherFlags flags;
};

TEST(GatherFlags, ItsOwnFlagAloneChoosesTheMethod) {
  for (const char* line :
       {"", "--quality draft", "--quality final", "--time-budget 1s", "--gather-rays 4",
        "--correction-paths 0", "--correction-paths 8", "--indirect gather", "--keep-light on"})
    EXPECT_EQ(indirect_of(Parsed(line).flags), Indirect::Gather) << line;
  const auto by = [](const std::string& line) { return indirect_of(Parsed(line).flags); };
  EXPECT_EQ(by("--indirect decoded --checkpoint a"), Indirect::Decoded);
  EXPECT_EQ(by("--indirect network --checkpoint a"), Indirect::Gather);
  EXPECT_EQ(by("--indirect paths --quality draft"), Indirect::Paths);
  EXPECT_EQ(table_settings(Parsed("").flags, 5, 0).light, TableLight::Raw);
  EXPECT_EQ(table_settings(Parsed("--indirect network").flags, 5, 0).light, TableLight::Network);
}

TEST(GatherFlags, WhatTheMethodDoesNotUseIsRefusedInOneLine) {
  const auto refuse = [](const std::string& line, bool neural, const std::string& words) {
    EXPECT_THAT([&] { Parsed(line, neural); },
                ThrowsMessage<Error>(AllOf(HasSubstr(words), testing::Not(HasSubstr("\n")))))
        << line;
  };
  refuse("--indirect decoded --gather-rays 4", true, "--gather-rays goes with --indirect gather");
  refuse("--indirect paths --table-points 100", true, "--table-points goes with");
  refuse("--checkpoint a", true, "--checkpoint goes with --indirect network or decoded");
  refuse("--indirect paths --draws 2", true, "--draws goes with --indirect network or decoded");
  refuse("--correction-paths 3", true, "--correction-paths 3: expected an even number");
  refuse("--correction-paths 8", false, "--correction-paths needs --mode neural");
  refuse("--indirect paths --correction-paths 8", true, "decoded, not paths");
  refuse("--gather-rays 4", false, "--gather-rays needs --mode neural");
  refuse("--indirect gather", false, "--indirect needs --mode neural");
}

}  // namespace
}  // namespace lte::infer
