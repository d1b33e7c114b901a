// Line charts as inline SVG, for the pages of html.h.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace lte::experiments {

struct ChartLine {
  std::string name;
  std::vector<std::pair<double, double>> points;  ///< x, y; what is not finite is left out
};

struct ChartStyle {
  std::string title{}, x_label{};
  bool log_x = false;    ///< values that are not positive are left out
  bool log_y = false;    ///< likewise
  bool markers = false;  ///< a dot at every point, for lines through a few measurements
  int width = 540;       ///< units of the drawing, which the page scales to the room there is
  int height = 270;      ///< without the legend
};

/// Lines over a common x, with axes, round ticks, and a legend in rows between title and plot,
/// where no line can cross it. A single line without a name has none. Colors repeat after sixteen
/// lines. A line of more points than the chart is wide is drawn through the means of equal shares
/// of them. A note instead of a chart if there is nothing to draw.
std::string html_chart(const ChartStyle& style, const std::vector<ChartLine>& lines);

}  // namespace lte::experiments
