#include "lte/report/chart.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "lte/base/check.h"
#include "lte/base/text.h"
#include "lte/report/html.h"

namespace lte {
namespace {

constexpr int kLeft = 62, kRight = 12, kTop = 26, kBottom = 36;
constexpr std::array<const char*, 16> kColors = {
    "#1f6fb4", "#d9541e", "#2b9348", "#8c4fb3", "#b8860b", "#0e9aa7", "#a83252", "#555555",
    "#e377c2", "#7f6a00", "#6baed6", "#fd8d3c", "#74c476", "#4b0082", "#e31a1c", "#a1794a"};
constexpr size_t kLegendInside = 6;  // lines whose names find room in the plot; more stand beside
constexpr double kLetterWidth = 6.5;
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

/// What can be drawn of a line, in the units of the axes: y is its logarithm where that is wanted.
/// Long lines become the means of as many equal shares as the chart has columns.
Points drawable(const ChartLine& line, const ChartStyle& style) {
  Points out;
  for (const auto& [x, y] : line.points) {
    if (!std::isfinite(x) || !std::isfinite(y) || (style.log_y && y <= 0)) continue;
    out.emplace_back(x, style.log_y ? std::log10(y) : y);
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

/// 1, 2 or 5 times a power of ten, about a fifth of `span`.
double tick_step(double span) {
  const double power = std::pow(10.0, std::floor(std::log10(span / 5)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= span / 5) return factor * power;
  }
  return 10 * power;
}

/// Values where ticks stand. Logarithms have them at whole decades if there are two of these, else
/// at 1, 2 and 5 of each.
std::vector<double> ticks(const Range& range, bool logarithmic) {
  std::vector<double> out;
  if (!logarithmic) {
    const double step = tick_step(range.high - range.low);
    for (double i = std::ceil(range.low / step); i * step <= range.high; ++i)
      out.push_back(i * step);
    return out;
  }
  const bool decades = std::floor(range.high) - std::ceil(range.low) >= 2;
  for (double decade = std::floor(range.low); decade <= range.high; ++decade) {
    for (const double digit : {1.0, 2.0, 5.0}) {
      const double place = decade + std::log10(digit);
      if (place >= range.low && place <= range.high && (digit == 1 || !decades))
        out.push_back(place);
    }
  }
  return out;
}

class Canvas {
 public:
  /// @param margin  to the right of the plot
  Canvas(const ChartStyle& style, const Range& x, const Range& y, double margin)
      : style_(style), x_(x), y_(y), right_(style.width - margin) {
    svg_ = concat("<svg width=", style.width, " height=", style.height, " viewBox=\"0 0 ",
                  style.width, " ", style.height, "\">\n");
    text(style.width / 2.0, 16, "middle", style.title, "#222");
    text(style.width / 2.0, style.height - 5, "middle", style.x_label, "#555");
  }

  void axes() {
    const double bottom = style_.height - kBottom;
    for (const double value : ticks(y_, style_.log_y)) {
      segment(kLeft, place_y(value), right_, place_y(value));
      text(kLeft - 5, place_y(value) + 4, "end",
           formatted("%.4g", style_.log_y ? std::pow(10.0, value) : value), "#555");
    }
    for (const double value : ticks(x_, false)) {
      segment(place_x(value), kTop, place_x(value), bottom);
      text(place_x(value), bottom + 14, "middle", formatted("%.6g", value), "#555");
    }
  }

  void line(const Points& points, const char* color) {
    std::string path;
    for (const auto& [x, y] : points) path += formatted("%.1f,%.1f ", place_x(x), place_y(y));
    svg_ += points.size() > 1
                ? concat("<polyline fill=none stroke-width=1.5 stroke=\"", color, "\" points=\"",
                         path, "\"/>\n")
                : formatted("<circle r=3 fill=\"%s\" cx=\"%.1f\" cy=\"%.1f\"/>\n", color,
                            place_x(points[0].first), place_y(points[0].second));
  }

  void legend(size_t place, const std::string& name, const char* color) {
    text(style_.width - kRight - 6, kTop + 14 + 14.0 * static_cast<double>(place), "end", name,
         color);
  }

  std::string finish() const { return svg_ + "</svg>\n"; }

 private:
  double place_x(double x) const {
    return kLeft + (x - x_.low) / (x_.high - x_.low) * (right_ - kLeft);
  }
  double place_y(double y) const {
    return style_.height - kBottom -
           (y - y_.low) / (y_.high - y_.low) * (style_.height - kTop - kBottom);
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
  double right_;  ///< end of the plot
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
  size_t longest = 0;
  for (const auto& line : drawn) longest = std::max(longest, line.first.size());
  const bool beside = drawn.size() > kLegendInside;
  Canvas canvas(style, x, y,
                kRight + (beside ? 6 + kLetterWidth * static_cast<double>(longest) : 0));
  canvas.axes();
  for (size_t i = 0; i < drawn.size(); ++i) {
    const char* const color = kColors[i % kColors.size()];
    canvas.line(drawn[i].second, color);
    canvas.legend(i, drawn[i].first, color);
  }
  return canvas.finish();
}

}  // namespace lte
