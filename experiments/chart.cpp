#include "experiments/chart.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "experiments/ticks.h"
#include "lte/base/check.h"
#include "lte/base/text.h"
#include "lte/report/html.h"

namespace lte::experiments {
namespace {

constexpr int kLeft = 66, kRight = 26, kTop = 30, kBottom = 44;
constexpr std::array<const char*, 16> kColors = {
    "#1f6fb4", "#d9541e", "#2b9348", "#8c4fb3", "#b8860b", "#0e9aa7", "#a83252", "#555555",
    "#e377c2", "#7f6a00", "#6baed6", "#fd8d3c", "#74c476", "#4b0082", "#e31a1c", "#a1794a"};
constexpr double kLetterWidth = 7, kLegendRow = 18, kKey = 18, kLegendGap = 16;
using Points = std::vector<std::pair<double, double>>;

struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  void extend(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  void open() {
    if (high > low) return;
    const double margin = low != 0 ? 0.05 * std::abs(low) : 1;
    low -= margin;
    high += margin;
  }
};

/// What can be drawn of a line, in the units of the axes: logarithms where they are wanted.
/// Long lines become the means of as many equal shares as the chart has columns.
Points drawable(const ChartLine& line, const ChartStyle& style) {
  Points out;
  for (const auto& [x, y] : line.points) {
    if (!std::isfinite(x) || !std::isfinite(y)) continue;
    if ((style.log_x && x <= 0) || (style.log_y && y <= 0)) continue;
    out.emplace_back(style.log_x ? std::log10(x) : x, style.log_y ? std::log10(y) : y);
  }
  const auto most = static_cast<size_t>(style.width);
  if (out.size() <= most) return out;
  Points means;
  for (size_t i = 0; i < most; ++i) {
    const size_t begin = i * out.size() / most, end = (i + 1) * out.size() / most;
    double x = 0, y = 0;
    for (size_t k = begin; k < end; ++k) {
      x += out[k].first;
      y += out[k].second;
    }
    const auto count = static_cast<double>(end - begin);
    means.emplace_back(x / count, y / count);
  }
  return means;
}

/// A line's name in the legend, and where it begins there.
struct LegendEntry {
  double x;
  int row;
};

/// Sets the entries beside one another, in as many rows as they need.
std::vector<LegendEntry> legend_layout(const std::vector<std::string>& names, double width) {
  std::vector<LegendEntry> out;
  double x = kLeft;
  int row = 0;
  for (const std::string& name : names) {
    const double wide = kKey + kLetterWidth * static_cast<double>(name.size()) + kLegendGap;
    if (x > kLeft && x + wide - kLegendGap > width) {
      x = kLeft;
      ++row;
    }
    out.push_back({x, row});
    x += wide;
  }
  return out;
}

class Canvas {
 public:
  /// @param legend  height of the legend between title and plot
  Canvas(const ChartStyle& style, const Range& x, const Range& y, double legend)
      : style_(style), x_(x), y_(y), top_(kTop + legend), height_(style.height + legend) {
    svg_ = formatted("<svg viewBox=\"0 0 %d %g\" role=img aria-label=\"%s\">\n", style.width,
                     height_, html_escape(style.title).c_str());
    text(style.width / 2.0, 19, "middle", style.title, "#222");
    text(style.width / 2.0, height_ - 7, "middle", style.x_label, "#555");
  }

  void axes() {
    const double bottom = height_ - kBottom;
    for (const double value : ticks(style_.log_y, y_)) {
      const double y = place_y(style_.log_y ? std::log10(value) : value);
      segment(kLeft, y, right(), y);
      text(kLeft - 6, y + 4, "end", formatted("%.4g", value), "#555");
    }
    for (const double value : ticks(style_.log_x, x_)) {
      const double x = place_x(style_.log_x ? std::log10(value) : value);
      segment(x, top_, x, bottom);
      text(x, bottom + 17, "middle", formatted("%.6g", value), "#555");
    }
  }

  void line(const Points& points, const char* color) {
    std::string path;
    for (const auto& [x, y] : points) path += formatted("%.1f,%.1f ", place_x(x), place_y(y));
    svg_ += points.size() > 1 ? concat("<polyline fill=none stroke-width=1.8 stroke=\"", color,
                                       "\" points=\"", path, "\"/>\n")
                              : dot(points[0], color);
    for (size_t i = 0; style_.markers && points.size() > 1 && i < points.size(); ++i)
      svg_ += dot(points[i], color);
  }

  void legend(const LegendEntry& entry, const std::string& name, const char* color) {
    const double y = kTop + 10 + kLegendRow * entry.row;
    svg_ += formatted("<path stroke-width=3 stroke=\"%s\" d=\"M%.1f %.1fh12\"/>\n", color, entry.x,
                      y - 4);
    text(entry.x + kKey, y, "start", name, color);
  }

  std::string finish() const { return svg_ + "</svg>\n"; }

 private:
  static std::vector<double> ticks(bool logarithmic, const Range& range) {
    return logarithmic ? log_ticks(std::pow(10.0, range.low), std::pow(10.0, range.high))
                       : linear_ticks(range.low, range.high);
  }
  std::string dot(const std::pair<double, double>& at, const char* color) const {
    return formatted("<circle r=3.5 fill=\"%s\" cx=\"%.1f\" cy=\"%.1f\"/>\n", color,
                     place_x(at.first), place_y(at.second));
  }
  double right() const { return style_.width - kRight; }
  double place_x(double x) const {
    return kLeft + (x - x_.low) / (x_.high - x_.low) * (right() - kLeft);
  }
  double place_y(double y) const {
    return height_ - kBottom - (y - y_.low) / (y_.high - y_.low) * (height_ - top_ - kBottom);
  }
  void segment(double x0, double y0, double x1, double y1) {
    svg_ += formatted("<path stroke=\"#e4e4e4\" d=\"M%.1f %.1fL%.1f %.1f\"/>\n", x0, y0, x1, y1);
  }
  void text(double x, double y, const char* anchor, const std::string& what, const char* color) {
    svg_ +=
        formatted("<text x=\"%.1f\" y=\"%.1f\" text-anchor=%s fill=\"%s\">", x, y, anchor, color);
    svg_ += html_escape(what) + "</text>\n";
  }

  const ChartStyle& style_;
  Range x_, y_;
  double top_, height_;  ///< of the plot's upper edge; of the drawing
  std::string svg_;
};

}  // namespace

std::string html_chart(const ChartStyle& style, const std::vector<ChartLine>& lines) {
  Range x, y;
  std::vector<std::pair<std::string, Points>> drawn;
  for (const ChartLine& line : lines) {
    Points points = drawable(line, style);
    if (points.empty()) continue;
    for (const auto& [px, py] : points) {
      x.extend(px);
      y.extend(py);
    }
    drawn.emplace_back(line.name, std::move(points));
  }
  if (drawn.empty())
    return concat("<p class=note>", html_escape(style.title), ": nothing recorded</p>\n");
  x.open();
  y.open();
  std::vector<std::string> names;
  names.reserve(drawn.size());
  for (const auto& line : drawn) names.push_back(line.first);
  const bool named = drawn.size() > 1 || !names.front().empty();
  const std::vector<LegendEntry> legend = legend_layout(names, style.width - kRight);
  Canvas canvas(style, x, y, named ? kLegendRow * (legend.back().row + 1) : 0);
  canvas.axes();
  for (size_t i = 0; i < drawn.size(); ++i) {
    const char* const color = kColors[i % kColors.size()];
    canvas.line(drawn[i].second, color);
    if (named) canvas.legend(legend[i], drawn[i].first, color);
  }
  return canvas.finish();
}

}  // namespace lte::experiments
