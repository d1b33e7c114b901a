#include <algorithm>
#include <functional>

#include "bench/pareto/pareto_report.h"
#include "lte/base/check.h"
#include "lte/base/parallel.h"
#include "lte/base/text.h"
#include "lte/report/chart.h"
#include "lte/report/html.h"

namespace lte::bench {

using namespace infer;

namespace {

/// One picture of a chart: what stands on its axes.
struct Axes {
  std::string title;
  std::function<double(const ParetoRow&)> seconds, error;
};

/// A line for each family and one for the front.
std::string draw(const ParetoChart& chart, const Axes& axes) {
  std::vector<ChartLine> lines;
  std::vector<std::pair<double, double>> points;
  for (const ParetoRow& row : chart.rows) {
    const std::pair<double, double> at{axes.seconds(row), axes.error(row)};
    points.push_back(at);
    const auto line = std::find_if(lines.begin(), lines.end(), [&](const ChartLine& known) {
      return known.name == row.family;
    });
    if (line == lines.end()) {
      lines.push_back({row.family, {at}});
    } else {
      line->points.push_back(at);
    }
  }
  ChartLine front{"front", {}};
  for (const size_t i : pareto_front(points)) front.points.push_back(points[i]);
  lines.push_back(front);
  return html_chart({.title = axes.title,
                     .x_label = "seconds",
                     .log_x = true,
                     .log_y = true,
                     .markers = true,
                     .height = 330},
                    lines);
}

std::vector<Axes> pictures() {
  const auto one = [](const ParetoRow& row) { return row.seconds(1); };
  std::vector<Axes> out = {
      {"relative MSE, one view", one, [](const ParetoRow& row) { return row.whole.relmse; }},
      {"relative MSE of indirect light, one view", one,
       [](const ParetoRow& row) { return row.indirect.relmse; }},
      {"FLIP, one view", one, [](const ParetoRow& row) { return row.whole.flip; }},
      {"1 - SSIM, one view", one, [](const ParetoRow& row) { return 1 - row.whole.ssim; }}};
  for (const int views : kViewCounts) {
    if (views == 1) continue;
    out.push_back({concat("relative MSE, ", views, " views"),
                   [views](const ParetoRow& row) { return row.seconds(views); },
                   [](const ParetoRow& row) { return row.whole.relmse; }});
  }
  return out;
}

std::string row_table(const ParetoChart& chart) {
  std::vector<std::vector<std::string>> rows;
  const std::vector<std::vector<int>> fronts = fronts_of(chart);
  for (size_t i = 0; i < chart.rows.size(); ++i) {
    const ParetoRow& row = chart.rows[i];
    const PictureScore own = without(chart.whole_noise, row.whole);
    std::string front;
    for (const int views : fronts[i]) front += concat(front.empty() ? "" : ", ", views);
    rows.push_back(
        {row.name, row.settings, formatted("%.3f", row.once.wall), formatted("%.3f", row.view.wall),
         formatted("%.3f", row.once.processor + row.view.processor),
         formatted("%.2e", row.whole.mse), formatted("%.2e", row.whole.relmse),
         formatted("%.2e", own.mse), formatted("%.2e", own.relmse),
         formatted("%.4f", row.whole.flip), formatted("%.4f", row.whole.ssim),
         formatted("%.2e", row.indirect.mse), formatted("%.2e", row.indirect.relmse),
         formatted("%.4f", row.indirect.flip), formatted("%.4f", row.indirect.ssim), front});
  }
  return html_table({"method", "settings", "once, s", "a view, s", "user + system of one, s", "MSE",
                     "relMSE", "own MSE", "own relMSE", "FLIP", "SSIM", "indirect: MSE", "relMSE",
                     "FLIP", "SSIM", "on the front at views"},
                    rows);
}

constexpr const char* kMeaning =
    "Pictures with direct and indirect light against a path-traced reference, means over views. "
    "Seconds are wall-clock, the least of the repeats; user and system seconds of all threads "
    "stand beside them, as machines are shared. N views take the time of what is done once and N "
    "times that of a view. Loading the scene and building its BVH are in no row, everything else "
    "is in all. relMSE divides both pictures by the reference's mean and is the mean of "
    "(a − b)² / (b² + 0.01). FLIP and SSIM are of pictures displayed at the reference's exposure. "
    "The front is of rows that no other row beats in time and error both.";

}  // namespace

std::string pareto_html(const ParetoOptions& options, const std::vector<ParetoChart>& charts) {
  std::string body = html_note(kMeaning);
  body += html_note(concat("Model ", options.checkpoint.empty() ? "as shipped" : options.checkpoint,
                           ", ", options.views, " views, least of ", options.repeats, " repeats, ",
                           num_threads(), " threads, reference of ", options.reference.spp,
                           " paths a pixel."));
  for (const ParetoChart& chart : charts) {
    body +=
        concat("<h2>", html_escape(chart.scene), ", ", chart.width, " × ", chart.height, "</h2>\n");
    std::string grid;
    for (const Axes& axes : pictures()) grid += draw(chart, axes);
    body += html_grid(grid) + row_table(chart);
    body += html_note(formatted(
        "%lld triangles, %lld lights. The reference's own noise adds %.1e to every MSE and %.1e to "
        "every relMSE, %.1e and %.1e to those of indirect light; own errors are without it.",
        static_cast<long long>(chart.triangles), static_cast<long long>(chart.lights),
        chart.whole_noise.mse, chart.whole_noise.relmse, chart.indirect_noise.mse,
        chart.indirect_noise.relmse));
  }
  return html_page("Run time against error", body);
}

}  // namespace lte::bench
