// Pages for people: escaping, embedding, and where a chart puts its points.
#include "lte/report/html.h"

#include <cmath>
#include <limits>
#include <set>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/report/chart.h"

namespace lte {
namespace {

using testing::HasSubstr;
using testing::Not;

std::vector<unsigned char> bytes(const std::string& text) { return {text.begin(), text.end()}; }

TEST(Html, EscapesText) {
  EXPECT_EQ(html_escape("a<b>&\"c'"), "a&lt;b&gt;&amp;&quot;c&#39;");
  EXPECT_THAT(html_table({"<x>"}, {{"<y>"}}), Not(HasSubstr("<x>")));
  EXPECT_THAT(html_page("<t>", ""), HasSubstr("<title>&lt;t&gt;</title>"));
}

TEST(Html, EncodesTheExamplesOfRfc4648) {
  const char* const examples[][2] = {{"", ""},
                                     {"f", "Zg=="},
                                     {"fo", "Zm8="},
                                     {"foo", "Zm9v"},
                                     {"foob", "Zm9vYg=="},
                                     {"fooba", "Zm9vYmE="},
                                     {"foobar", "Zm9vYmFy"}};
  for (const auto& [text, encoded] : examples) EXPECT_EQ(base64(bytes(text)), encoded);
}

TEST(Html, MarksTheRowThatStandsOut) {
  const std::string table = html_table({"a", "b"}, {{"x", "1"}, {"y", "2"}}, "y");
  EXPECT_THAT(table, HasSubstr("<tr class=own><td>y</td><td>2</td></tr>"));
  EXPECT_THAT(table, HasSubstr("<tr><td>x</td>"));
}

TEST(Chart, SpansItsAxesFromCornerToCorner) {
  // Margins: 62 left, 12 right, 26 top, 36 bottom of 640 x 260.
  const std::string chart =
      html_chart({.title = "t", .x_label = "step"}, {{"a", {{0, 0}, {10, 5}}}});
  EXPECT_THAT(chart, HasSubstr("points=\"62.0,224.0 628.0,26.0 \""));
}

TEST(Chart, TakesLogarithmsAndLeavesOutWhatHasNone) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::string chart =
      html_chart({.title = "t", .log_y = true},
                 {{"a", {{0, 1}, {1, 10}, {2, 100}, {3, 0}, {4, nan}, {5, -1}}}});
  EXPECT_THAT(chart, HasSubstr("points=\"62.0,224.0 345.0,125.0 628.0,26.0 \""));
}

TEST(Chart, SaysSoWhenThereIsNothing) {
  EXPECT_THAT(html_chart({.title = "loss"}, {{"a", {}}}), HasSubstr("loss: nothing recorded"));
  EXPECT_THAT(html_chart({.title = "loss"}, {{"a", {{3, 7}}}}), HasSubstr("<circle"));
}

TEST(Chart, SetsManyNamesBesideThePlotInColorsOfTheirOwn) {
  std::vector<ChartLine> lines;
  for (int i = 0; i < 14; ++i) lines.push_back({"line" + std::to_string(i), {{0, i}, {1, i + 1}}});
  const std::string chart = html_chart({.title = "t"}, lines);
  std::set<std::string> colors;
  for (size_t at = chart.find("stroke=\"#"); at != std::string::npos;
       at = chart.find("stroke=\"#", at + 1)) {
    const std::string color = chart.substr(at + 8, 7);
    if (color != "#e4e4e4") colors.insert(color);
  }
  EXPECT_EQ(colors.size(), 14u);
  // Names end 18 from the right edge; six letters of 6.5 and a gap of 6 stand between.
  EXPECT_THAT(chart, HasSubstr("<text x=\"622.0\" y=\"40.0\" text-anchor=end"));
  EXPECT_THAT(chart, HasSubstr(" 583.0,"));
  EXPECT_THAT(chart, Not(HasSubstr(" 628.0,")));
}

TEST(Chart, DrawsLongLinesThroughMeans) {
  ChartLine line{"a", {}};
  for (int i = 0; i < 10'000; ++i) line.points.emplace_back(i, i % 2);
  const std::string chart = html_chart({.title = "t"}, {line});
  EXPECT_LT(chart.size(), 20'000u);
}

}  // namespace
}  // namespace lte
