// Line charts as inline SVG, for the pages of html.h.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace lte {

struct ChartLine {
  std::string name;
  std::vector<std::pair<double, double>> points;  ///< x, y; what is not finite is left out
};

struct ChartStyle {
  std::string title{}, x_label{};
  bool log_y = false;  ///< values that are not positive are left out
  int width = 640, height = 260;
};

/// Lines over a common x, with axes, round ticks and a legend: in the plot, or beside it where more
/// than six names would cover the lines. Colors repeat after sixteen lines. A line of more points
/// than the chart is wide is drawn through the means of equal shares of them. A note instead of a
/// chart if there is nothing to draw.
std::string html_chart(const ChartStyle& style, const std::vector<ChartLine>& lines);

}  // namespace lte
