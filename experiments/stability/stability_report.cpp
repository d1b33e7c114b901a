#include "experiments/stability/stability_report.h"

#include <algorithm>
#include <utility>

#include <nlohmann/json.hpp>

#include "experiments/chart.h"
#include "lte/base/check.h"
#include "lte/base/parallel.h"
#include "lte/base/text.h"
#include "lte/report/html.h"

namespace lte::experiments {
namespace {

const char* figure_name(Figure figure) {
  switch (figure) {
    case Figure::Shift:
      return "shift";
    case Figure::Mean:
      return "mean";
    case Figure::Max:
      return "max";
    case Figure::None:
      break;
  }
  return "";
}

std::string bound_text(const Bound& bound) {
  if (bound.of == Figure::None) return "";
  if (bound.most == 0) return "exactly 0";
  return formatted("%s ≤ %.1e", figure_name(bound.of), bound.most);
}

std::string change_text(double change) { return change == 0 ? "0" : formatted("%.1e", change); }

const std::vector<std::string> kHead = {"case",  "of",    "against", "not finite",
                                        "shift", "mean",  "99 %",    "max",
                                        "bound", "holds", "seconds", "user + system"};

std::vector<std::string> cells_of(const StabilityRow& row) {
  const Change& change = row.change;
  return {row.name,
          row.what,
          row.against,
          std::to_string(change.non_finite),
          change_text(change.shift),
          change_text(change.mean),
          change_text(change.p99),
          change_text(change.most),
          bound_text(row.bound),
          row.holds() ? "yes" : "NO",
          formatted("%.2f", row.seconds),
          formatted("%.2f", row.processor_seconds)};
}

/// The rows of a group, which follow one another.
std::vector<std::pair<std::string, std::vector<std::vector<std::string>>>> groups_of(
    const std::vector<StabilityRow>& rows) {
  std::vector<std::pair<std::string, std::vector<std::vector<std::string>>>> groups;
  for (const StabilityRow& row : rows) {
    if (groups.empty() || groups.back().first != row.group) groups.push_back({row.group, {}});
    groups.back().second.push_back(cells_of(row));
  }
  return groups;
}

std::string time_chart(const std::vector<StabilityRow>& rows) {
  ChartLine bvh{"BVH and lights", {}}, paths{"paths", {}},
      network{"network, encoding included", {}};
  for (const StabilityRow& row : rows) {
    if (row.group != "triangles") continue;
    const auto triangles = static_cast<double>(row.triangles);
    (row.what == "paths" ? paths : network).points.emplace_back(triangles, row.seconds);
    if (row.what == "paths") bvh.points.emplace_back(triangles, row.bvh_seconds);
  }
  return html_grid(html_chart({.title = "Seconds by triangles",
                               .x_label = "triangles",
                               .log_x = true,
                               .log_y = true,
                               .markers = true},
                              {bvh, paths, network}));
}

constexpr const char* kMeaning =
    "One room, changed in ways that leave its light alone. Changes are over the mean of the base "
    "case's answers: of the mean (shift, blind to noise), mean, 99th percentile and largest of the "
    "absolute differences. Paths are irradiance of all depths by path tracing at fixed points; the "
    "network answers at the same points, with scene points, light estimates and encoding of its "
    "own. Factors that are powers of two change no bit. A bound of noise is that of another seed, "
    "or three times it.";

}  // namespace

bool all_hold(const std::vector<StabilityRow>& rows) {
  return std::all_of(rows.begin(), rows.end(), [](const StabilityRow& row) { return row.holds(); });
}

std::string stability_verdict(const std::vector<StabilityRow>& rows) {
  if (all_hold(rows))
    return concat("all ", rows.size(), " rows are finite and within their bounds");
  const auto broken = [](const StabilityRow& row) { return !row.holds(); };
  const auto first = std::find_if(rows.begin(), rows.end(), broken);
  return concat(std::count_if(rows.begin(), rows.end(), broken), " of ", rows.size(),
                " rows break their bound, first ", first->group, ", ", first->name, " (",
                first->what, "): ", first->change.non_finite, " not finite, ",
                figure_name(first->bound.of), " ", first->change.of(first->bound.of), ", at most ",
                first->bound.most);
}

std::string stability_table(const std::vector<StabilityRow>& rows) {
  std::string out =
      formatted("%-10s %-32s %-8s %6s %9s %9s %9s %9s  %-16s %-5s %8s %8s\n", "group", "case", "of",
                "not f.", "shift", "mean", "99 %", "max", "bound", "holds", "seconds", "u + s");
  for (const StabilityRow& row : rows) {
    const std::vector<std::string> c = cells_of(row);
    const std::string bound =
        row.bound.of == Figure::None ? ""
        : row.bound.most == 0        ? "exactly 0"
                              : formatted("%s <= %.1e", figure_name(row.bound.of), row.bound.most);
    out += formatted("%-10s %-32s %-8s %6s %9s %9s %9s %9s  %-16s %-5s %8s %8s\n",
                     row.group.c_str(), c[0].c_str(), c[1].c_str(), c[3].c_str(), c[4].c_str(),
                     c[5].c_str(), c[6].c_str(), c[7].c_str(), bound.c_str(), c[9].c_str(),
                     c[10].c_str(), c[11].c_str());
  }
  return out + stability_verdict(rows) + "\n";
}

std::string stability_json(const StabilityOptions& options, const std::vector<StabilityRow>& rows) {
  nlohmann::json out{{"command", "stability"},           {"quick", options.quick},
                     {"checkpoint", options.checkpoint}, {"threads", num_threads()},
                     {"holds", all_hold(rows)},          {"rows", nlohmann::json::array()}};
  for (const StabilityRow& row : rows) {
    nlohmann::json json{{"group", row.group},
                        {"name", row.name},
                        {"what", row.what},
                        {"against", row.against},
                        {"values", row.change.values},
                        {"non_finite", row.change.non_finite},
                        {"shift", row.change.shift},
                        {"mean", row.change.mean},
                        {"p99", row.change.p99},
                        {"max", row.change.most},
                        {"holds", row.holds()},
                        {"triangles", row.triangles},
                        {"seconds", row.seconds},
                        {"processor_seconds", row.processor_seconds},
                        {"bvh_seconds", row.bvh_seconds}};
    if (row.bound.of != Figure::None)
      json["bound"] = {{"of", figure_name(row.bound.of)}, {"most", row.bound.most}};
    out["rows"].push_back(json);
  }
  return out.dump(1) + "\n";
}

std::string stability_html(const StabilityOptions& options, const std::vector<StabilityRow>& rows) {
  const std::string verdict = stability_verdict(rows);
  std::string body = all_hold(rows) ? html_headline(verdict) : html_warning(verdict);
  body += html_note(kMeaning);
  body += html_note(concat("Model ", options.checkpoint.empty() ? "as shipped" : options.checkpoint,
                           ", ", num_threads(), " threads. Seconds are of one run of each row."));
  for (const auto& [group, cells] : groups_of(rows)) {
    body += concat("<h2>", html_escape(group), "</h2>\n") + html_table(kHead, cells);
    if (group == "triangles") body += time_chart(rows);
  }
  return html_page("Stress of numbers", body);
}

}  // namespace lte::experiments
