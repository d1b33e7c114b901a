// Charts: where points and legends stand.
#include "experiments/chart.h"

#include <algorithm>
#include <limits>
#include <set>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace lte::experiments {
namespace {

using testing::HasSubstr;

// Margins: 66 left, 26 right, 30 top, 44 bottom of 540 x 270; a row of the legend takes 18.
TEST(Chart, SpansItsAxesFromCornerToCorner) {
  const std::string chart =
      html_chart({.title = "t", .x_label = "step"}, {{"", {{0, 0}, {10, 5}}}});
  EXPECT_THAT(chart, HasSubstr("viewBox=\"0 0 540 270\""));
  EXPECT_THAT(chart, HasSubstr("points=\"66.0,226.0 514.0,30.0 \""));
}

TEST(Chart, TakesLogarithmsAndLeavesOutWhatHasNone) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::string chart =
      html_chart({.title = "t", .log_y = true},
                 {{"", {{0, 1}, {1, 10}, {2, 100}, {3, 0}, {4, nan}, {5, -1}}}});
  EXPECT_THAT(chart, HasSubstr("points=\"66.0,226.0 290.0,128.0 514.0,30.0 \""));
}

TEST(Chart, PutsPowerLawsOnAStraightLineWithADotAtEachPoint) {
  const std::string chart =
      html_chart({.title = "t", .log_x = true, .log_y = true, .markers = true},
                 {{"", {{0.01, 100}, {1, 1}, {100, 0.01}, {0, 1}, {-1, 1}}}});
  EXPECT_THAT(chart, HasSubstr("points=\"66.0,30.0 290.0,128.0 514.0,226.0 \""));
  EXPECT_THAT(chart, HasSubstr("cx=\"290.0\" cy=\"128.0\""));
  EXPECT_THAT(chart, HasSubstr(">0.01</text>"));
}

TEST(Chart, SaysSoWhenThereIsNothing) {
  EXPECT_THAT(html_chart({.title = "loss"}, {{"a", {}}}), HasSubstr("loss: nothing recorded"));
  EXPECT_THAT(html_chart({.title = "loss"}, {{"a", {{3, 7}}}}), HasSubstr("<circle"));
}

TEST(Chart, KeepsLinesOutOfTheLegend) {
  std::vector<ChartLine> lines;
  for (int i = 0; i < 14; ++i)
    lines.push_back({"validation scene " + std::to_string(i), {{0, i}, {1, i + 1}}});
  const std::string chart = html_chart({.title = "t"}, lines);
  std::set<std::string> colors;
  double highest_line = 1e9, lowest_key = 0;
  for (size_t at = chart.find("<polyline"); at != std::string::npos;
       at = chart.find("<polyline", at + 1)) {
    colors.insert(chart.substr(chart.find("stroke=", at), 16));
    // Lines rise: their last point is the highest.
    const size_t last = chart.find(" \"", chart.find("points=", at));
    highest_line = std::min(highest_line, std::stod(chart.substr(chart.rfind(',', last) + 1)));
  }
  for (size_t at = chart.find("stroke-width=3"); at != std::string::npos;
       at = chart.find("stroke-width=3", at + 1)) {
    const size_t place = chart.find(' ', chart.find("d=\"M", at));
    lowest_key = std::max(lowest_key, std::stod(chart.substr(place)));
  }
  EXPECT_EQ(colors.size(), 14u);
  EXPECT_GT(lowest_key, 30 + 18) << "14 names take more than a row";
  EXPECT_LT(lowest_key, highest_line);
}

TEST(Chart, DrawsLongLinesThroughMeans) {
  ChartLine line{"a", {}};
  for (int i = 0; i < 10'000; ++i) line.points.emplace_back(i, i % 2);
  const std::string chart = html_chart({.title = "t"}, {line});
  EXPECT_LT(chart.size(), 20'000u);
}

}  // namespace
}  // namespace lte::experiments
