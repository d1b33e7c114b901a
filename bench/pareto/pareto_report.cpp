#include "bench/pareto/pareto_report.h"

#include <nlohmann/json.hpp>

#include "lte/base/json_number.h"
#include "lte/base/parallel.h"
#include "lte/base/text.h"

namespace lte::bench {

using namespace infer;

namespace {

using Json = nlohmann::json;

Json json_of(const ReferenceNoise& noise) {
  return {{"mse", json_number(noise.mse)}, {"relmse", json_number(noise.relmse)}};
}

Json json_of(const PictureScore& score, const ReferenceNoise& noise) {
  const PictureScore own = without(noise, score);
  return {{"mse", json_number(score.mse)},   {"relmse", json_number(score.relmse)},
          {"own_mse", json_number(own.mse)}, {"own_relmse", json_number(own.relmse)},
          {"flip", json_number(score.flip)}, {"ssim", json_number(score.ssim)}};
}

Json json_of(const Seconds& time) {
  return {{"seconds", time.wall}, {"processor_seconds", time.processor}};
}

Json json_of(const ParetoRow& row, const ParetoChart& chart, const std::vector<int>& fronts) {
  Json seconds;
  for (const int views : kViewCounts) seconds[std::to_string(views)] = row.seconds(views);
  return {{"name", row.name},
          {"family", row.family},
          {"settings", row.settings},
          {"once", json_of(row.once)},
          {"view", json_of(row.view)},
          {"seconds_of_views", seconds},
          {"whole", json_of(row.whole, chart.whole_noise)},
          {"indirect", json_of(row.indirect, chart.indirect_noise)},
          {"on_front_of_views", fronts}};
}

/// Of each row, the numbers of views (kViewCounts) at which it is on the front of time against the
/// relative MSE of the whole picture.
std::vector<std::vector<int>> fronts_of(const ParetoChart& chart) {
  std::vector<std::vector<int>> out(chart.rows.size());
  for (const int views : kViewCounts) {
    std::vector<std::pair<double, double>> points;
    for (const ParetoRow& row : chart.rows)
      points.emplace_back(row.seconds(views), row.whole.relmse);
    for (const size_t i : pareto_front(points)) out[i].push_back(views);
  }
  return out;
}

}  // namespace

std::string pareto_table(const std::vector<ParetoChart>& charts) {
  std::string out;
  for (const ParetoChart& chart : charts) {
    out += formatted(
        "%s, %d x %d, %lld triangles; front: numbers of views at which no row is both "
        "faster and closer\n",
        chart.scene.c_str(), chart.width, chart.height, static_cast<long long>(chart.triangles));
    out += formatted(
        "own: without the reference's noise, MSE %.1e and relMSE %.1e, of indirect light %.1e and "
        "%.1e\n",
        chart.whole_noise.mse, chart.whole_noise.relmse, chart.indirect_noise.mse,
        chart.indirect_noise.relmse);
    out += formatted("%-20s %9s %9s %9s  %9s %9s %9s %9s %7s %7s  %9s %9s  %s\n", "method",
                     "once s", "a view s", "u + s", "MSE", "relMSE", "own MSE", "relMSE", "FLIP",
                     "SSIM", "ind. MSE", "relMSE", "front");
    const std::vector<std::vector<int>> fronts = fronts_of(chart);
    for (size_t i = 0; i < chart.rows.size(); ++i) {
      const ParetoRow& row = chart.rows[i];
      const PictureScore own = without(chart.whole_noise, row.whole);
      out += formatted("%-20s %9.3f %9.3f %9.3f  %9.2e %9.2e %9.2e %9.2e %7.4f %7.4f  %9.2e %9.2e ",
                       row.name.c_str(), row.once.wall, row.view.wall,
                       row.once.processor + row.view.processor, row.whole.mse, row.whole.relmse,
                       own.mse, own.relmse, row.whole.flip, row.whole.ssim, row.indirect.mse,
                       row.indirect.relmse);
      for (const int views : fronts[i]) out += " " + std::to_string(views);
      out += "\n";
    }
  }
  return out;
}

std::string pareto_json(const ParetoOptions& options, const std::vector<ParetoChart>& charts) {
  Json out{{"command", "pareto"},
           {"checkpoint", options.checkpoint},
           {"threads", num_threads()},
           {"views", options.views},
           {"repeats", options.repeats},
           {"seed", options.seed},
           {"reference_spp", options.reference_spp},
           {"charts", Json::array()}};
  for (const ParetoChart& chart : charts) {
    Json json{
        {"scene", chart.scene},
        {"width", chart.width},
        {"height", chart.height},
        {"triangles", chart.triangles},
        {"lights", chart.lights},
        {"reference_noise",
         {{"whole", json_of(chart.whole_noise)}, {"indirect", json_of(chart.indirect_noise)}}},
        {"rows", Json::array()}};
    const std::vector<std::vector<int>> fronts = fronts_of(chart);
    for (size_t i = 0; i < chart.rows.size(); ++i)
      json["rows"].push_back(json_of(chart.rows[i], chart, fronts[i]));
    out["charts"].push_back(json);
  }
  return out.dump(1) + "\n";
}

}  // namespace lte::bench
