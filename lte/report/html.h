// Self-contained HTML pages for reports: tables, embedded pictures, line charts as inline SVG. No
// script, no font and no other file is needed to read them.
#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

namespace lte {

/// Text with &, <, > and quotes replaced by their entities.
std::string html_escape(const std::string& text);

/// RFC 4648, with padding.
std::string base64(std::span<const unsigned char> bytes);

/// A whole document; `body` is HTML.
std::string html_page(const std::string& title, const std::string& body);

/// Cells are text. The first column is set to the left, the others to the right; rows whose first
/// cell is `own` stand out.
std::string html_table(const std::vector<std::string>& head,
                       const std::vector<std::vector<std::string>>& rows,
                       const std::string& own = "");

/// A PNG file's bytes with a caption.
std::string html_picture(std::span<const unsigned char> png, const std::string& caption);

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
