#include "experiments/directions/incident_page.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "experiments/chart.h"
#include "infer/eval/report/eval_report.h"
#include "infer/eval/report/picture_sheet.h"
#include "lte/base/check.h"
#include "lte/image/png.h"
#include "lte/image/tonemap.h"
#include "lte/report/html.h"

namespace lte::experiments {

using namespace infer;

namespace {

using image::Image;

constexpr int kZoom = 5;  ///< pixels of a cell
const Rgb kBelowZero{0.1f, 0.2f, 1};

/// Rows that do not depend on a degree.
std::vector<std::pair<std::string, MapErrors>> flat_rows(const IncidentResult& result) {
  std::vector<std::pair<std::string, MapErrors>> rows = {{"neural", result.neural}};
  rows.emplace_back("what rays see of the points", result.seen);
  rows.emplace_back("the model's irradiance from everywhere", result.even);
  if (result.traced_paths > 0)
    rows.emplace_back(concat("traced, ", result.traced_paths, " paths a direction"), result.traced);
  return rows;
}

void add_point(const std::string& name, double x, double y, std::vector<ChartLine>* lines) {
  if (lines->empty() || lines->back().name != name) lines->push_back({name, {}});
  lines->back().points.emplace_back(x, y);
}

/// What the errors are drawn over.
enum class Axis { Degree, Numbers };

std::string error_chart(const IncidentResult& result, Axis axis, const std::string& title,
                        double MapErrors::*member) {
  const bool by_degree = axis == Axis::Degree;
  std::vector<ChartLine> lines;
  for (const HarmonicErrors& h : result.harmonics)
    add_point(concat("harmonics, ", enum_name(h.fit)), by_degree ? h.degree : h.numbers(),
              h.errors.*member, &lines);
  if (!by_degree) {
    for (const GaussianErrors& g : result.gaussians)
      add_point(concat("Gaussians, ", enum_name(g.fit)), g.numbers(), g.errors.*member, &lines);
  }
  double lowest = 0, highest = 0;
  for (const ChartLine& line : lines) {
    lowest = line.points.front().first;
    highest = std::max(highest, line.points.back().first);
  }
  for (const auto& [name, errors] : flat_rows(result))
    lines.push_back({name, {{lowest, errors.*member}, {highest, errors.*member}}});
  ChartStyle style;
  style.title = title;
  style.x_label = by_degree ? "l of the harmonics at most" : "numbers stored for a map";
  style.log_x = !by_degree;
  style.log_y = true;
  return html_chart(style, lines);
}

std::string error_charts(const IncidentResult& result, Axis axis) {
  return html_grid(
      error_chart(result, axis, "logrel: relative error of log(x + 1)", &MapErrors::logrel) +
      error_chart(result, axis, "log_mse: squared error of log(x + 1)", &MapErrors::log_mse) +
      error_chart(result, axis, "mse: squared error of x", &MapErrors::mse));
}

Image picture_of(const at::Tensor& map, float exposure) {
  const auto edge = static_cast<int>(std::lround(std::sqrt(static_cast<double>(map.size(0)))));
  Image linear(edge, edge, 3);
  const auto values = map.accessor<double, 2>();
  const auto rgb_at = [&](int x, int y) {
    const int64_t cell = int64_t{y} * edge + x;
    return Rgb{static_cast<float>(values[cell][0]), static_cast<float>(values[cell][1]),
               static_cast<float>(values[cell][2])};
  };
  for (int y = 0; y < edge; ++y)
    for (int x = 0; x < edge; ++x) linear.set_rgb(x, y, rgb_at(x, y));
  Image display = image::tonemap(linear, exposure);
  for (int y = 0; y < edge; ++y) {
    for (int x = 0; x < edge; ++x)
      if (luminance(rgb_at(x, y)) < 0) display.set_rgb(x, y, kBelowZero);
  }
  return display;
}

/// A row of maps at the exposure of the first, which is the reference.
Image row_of(const MapRow& row) {
  const at::Tensor& reference = row.maps.front().second;
  const auto edge =
      static_cast<int>(std::lround(std::sqrt(static_cast<double>(reference.size(0)))));
  Image linear(edge, edge, 3);
  const auto values = reference.accessor<double, 2>();
  for (int64_t cell = 0; cell < reference.size(0); ++cell)
    for (int c = 0; c < 3; ++c)
      linear.at(static_cast<int>(cell % edge), static_cast<int>(cell / edge))[c] =
          static_cast<float>(values[cell][c]);
  const float exposure = image::auto_exposure(linear);
  std::vector<Image> pictures;
  for (const auto& named : row.maps) pictures.push_back(picture_of(named.second, exposure));
  return side_by_side(pictures, kZoom);
}

std::string maps(const IncidentResult& result) {
  if (result.pictures.empty()) return "";
  std::vector<Image> rows;
  std::string columns, places;
  for (const auto& named : result.pictures.front().maps)
    columns += (columns.empty() ? "" : " | ") + named.first;
  for (const MapRow& row : result.pictures) {
    rows.push_back(row_of(row));
    places += (places.empty() ? "" : ", ") + row.place;
  }
  const std::vector<unsigned char> png = image::encode_png(stacked(rows));
  return "<h2>Maps</h2>\n" +
         html_note(concat("A row a point (", places, "), columns: ", columns,
                          ". Where harmonics ring below zero, the map is blue.")) +
         html_picture(png, columns);
}

std::string table(const IncidentResult& result) {
  std::vector<std::vector<std::string>> rows;
  for (const auto& [name, e] : flat_rows(result))
    rows.push_back({name, "", figure(e.logrel), figure(e.log_mse), figure(e.mse), ""});
  for (const HarmonicErrors& h : result.harmonics) {
    if (h.degree % 2 == 1 && h.degree > 3) continue;
    rows.push_back({concat("l ≤ ", h.degree, ", ", enum_name(h.fit)), concat(h.numbers()),
                    figure(h.errors.logrel), figure(h.errors.log_mse), figure(h.errors.mse),
                    figure(h.negative)});
  }
  for (const GaussianErrors& g : result.gaussians)
    rows.push_back({concat(g.lobes, " Gaussians, ", enum_name(g.fit)), concat(g.numbers()),
                    figure(g.errors.logrel), figure(g.errors.log_mse), figure(g.errors.mse), "0"});
  return html_table({"", "numbers a map", "logrel", "log_mse", "mse", "share below zero"}, rows,
                    "neural");
}

}  // namespace

std::string incident_html(const IncidentResult& result, const std::string& model,
                          const std::string& data) {
  std::string body = html_note(concat("Model ", model, "; data ", data, "; ", result.points,
                                      " points, ", result.cells, " directions each."));
  body += error_charts(result, Axis::Degree);
  if (!result.gaussians.empty())
    body += "<h2>At equal storage</h2>\n" + error_charts(result, Axis::Numbers);
  body += maps(result) + "<h2>Error</h2>\n" + table(result);
  body += html_note(
      "x is π times radiance over the scene's mean emission, of light that has bounced before. "
      "logrel divides by the reference and so forgives what is too dark; log_mse does not. "
      "Harmonics and Gaussians are fitted to the reference itself. Formulas: docs/metrics.md of "
      "lte.");
  return html_page(
      concat("Radiance by direction in ", result.scenes, result.scenes == 1 ? " scene" : " scenes"),
      body);
}

}  // namespace lte::experiments
