// What an evaluation says first, on made-up figures.
#include "infer/eval/report/eval_report.h"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/temp_dir.h"

namespace lte::infer {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

Score score_of(double points, double views) {
  Score out;
  out.points[0] = points;
  out.views[0] = views;
  return out;
}

/// Two scenes; the network's MSE is `points` and `views`, that of a constant 2 and 2.
EvalResult result_of(double points, double views) {
  EvalResult out;
  out.split = "test";
  const Scores scores = {{"neural", score_of(points, views)}, {"constant_mean", score_of(2, 2)}};
  out.scenes.resize(2);
  out.scenes[0].name = "kitchen";
  out.scenes[1].name = "hall";
  for (SceneResult& scene : out.scenes) scene.scores = scores;
  out.mean = out.median = scores;
  ScoreInterval bounds;
  bounds.low = score_of(0.5, 0.25);
  bounds.high = score_of(1.5, 1.75);
  out.mean_interval = out.median_interval = {{"neural", bounds}, {"constant_mean", bounds}};
  const EqualSamples point_samples{32.4, 31, {9.4, 86.2}, {}},
      pixel_samples{64.9, 60, {49, 86}, {}};
  out.equal_samples = {{"neural", point_samples, pixel_samples}};
  return out;
}

/// The same of its first scene alone.
EvalResult one_scene(EvalResult result) {
  result.scenes.resize(1);
  const ScoreInterval none{score_of(kNone, kNone), score_of(kNone, kNone)};
  for (auto* intervals : {&result.mean_interval, &result.median_interval})
    for (auto& entry : *intervals) entry.second = none;
  for (PredictorSamples& entry : result.equal_samples)
    entry.points.interval = entry.views.interval = {kNone, kNone};
  return result;
}

TEST(EvalHeadline, SaysWhatTheErrorIsWorth) {
  EXPECT_EQ(eval_headline(result_of(1, 1)),
            "Worth 65 path-traced samples a pixel (95 %: 49 to 86) and 32 path-traced samples a "
            "point (95 %: 9.4 to 86).");
}

TEST(EvalHeadline, HasNoIntervalOfOneScene) {
  EXPECT_EQ(eval_headline(one_scene(result_of(1, 1))),
            "Worth 65 path-traced samples a pixel and 32 path-traced samples a point.");
}

TEST(EvalHeadline, FallsBackToErrorsWithoutPathTracedEstimates) {
  EvalResult result = result_of(0.25, 0.5);
  result.equal_samples.clear();
  EXPECT_EQ(eval_headline(result), "Mean squared error 0.25 at points, 0.5 in views.");
}

TEST(EvalVerdict, ComparesWithAConstant) {
  EXPECT_FALSE(worse_than_constant(result_of(1, 0.5)));
  EXPECT_THAT(eval_verdict(result_of(1, 0.5)), StartsWith("Better than a constant"));
  EXPECT_THAT(eval_verdict(result_of(1, 0.5)),
              HasSubstr("0.5 times that at points, 0.25 times that in views"));
  for (const auto& [points, views] : {std::pair{3.0, 0.5}, {0.5, 3.0}, {3.0, kNone}}) {
    EXPECT_TRUE(worse_than_constant(result_of(points, views)));
    EXPECT_THAT(eval_verdict(result_of(points, views)), StartsWith("Worse than a constant"));
  }
  EvalResult alone = result_of(1, 1);
  alone.mean.pop_back();
  EXPECT_EQ(eval_verdict(alone), "");
}

TEST(EvalTable, EndsWithHeadlineAndVerdict) {
  const std::string table = eval_table(result_of(3, 1));
  EXPECT_GT(table.find("Worth 65"), table.find("105 scenes of the paper"));
  EXPECT_THAT(table, HasSubstr("\nWorse than a constant"));
}

class EvalPage : public testing::Test {
 protected:
  EvalPage() : sheets_(folder_.path()) {
    std::vector<Rgb> values(12 * 12, Rgb{1, 1, 1});
    view_.width = view_.height = 12;
    view_.mask.assign(values.size(), 1);
    sheets_.add({"kitchen", 0, view_, values, values, {}});
  }
  std::string page(const EvalResult& result) const {
    return eval_html(result, "model", "data", sheets_);
  }

  test::TempDir folder_;
  data::View view_;
  ContactSheets sheets_;
};

TEST_F(EvalPage, LeadsWithHeadlineVerdictAndPictures) {
  const std::string text = page(result_of(3, 1));
  const size_t headline = text.find("<p class=headline>Worth 65"),
               verdict = text.find("<p class=warning>Worse than a constant"),
               picture = text.find("data:image/png"), table = text.find("<table>");
  ASSERT_NE(headline, std::string::npos);
  EXPECT_LT(headline, verdict);
  EXPECT_LT(verdict, picture);
  EXPECT_LT(picture, table);
  ASSERT_NE(table, std::string::npos);
  EXPECT_THAT(text, HasSubstr("href=\"#meaning\""));
  EXPECT_THAT(text, HasSubstr("id=meaning"));
  EXPECT_THAT(text, HasSubstr("3 (0.5–1.5)"));
}

TEST_F(EvalPage, HasNoIntervalOfOneScene) {
  const std::string text = page(one_scene(result_of(1, 1)));
  EXPECT_THAT(text, HasSubstr("no intervals"));
  EXPECT_THAT(text, Not(HasSubstr("–")));
  EXPECT_THAT(text, HasSubstr("on 1 scene of split test"));
  EXPECT_THAT(eval_table(one_scene(result_of(1, 1))), Not(HasSubstr("95 %, from")));
}

}  // namespace
}  // namespace lte::infer
