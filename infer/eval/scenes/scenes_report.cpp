// What lte_eval scenes says: on the terminal, as JSON and as a page.
#include <algorithm>
#include <cmath>
#include <span>

#include <nlohmann/json.hpp>

#include "infer/eval/scenes/figures_json.h"
#include "infer/eval/scenes/scenes.h"
#include "lte/base/json_number.h"
#include "lte/base/text.h"
#include "lte/base/version.h"
#include "lte/report/html.h"

namespace lte::infer {
namespace {

using TextRows = std::vector<std::vector<std::string>>;

constexpr const char* kRightText =
    "Right: mean within 5 %, 8x8 blocks within 10 %, worth at least 64 paths a pixel, all of "
    "indirect irradiance.";

std::string number_text(double value) {
  return std::isfinite(value) ? formatted("%.3g", value) : "-";
}

std::string percent_text(double value) {
  return std::isfinite(value) ? formatted("%.3g %%", 100 * value) : "-";
}

std::string worth_text(const PairError& error) {
  if (!error.measured()) return "-";
  return (error.below_noise ? "over " : "") + number_text(error.worth);
}

bool is_measured(const MethodOutcome& method) { return method.not_measured.empty(); }

std::vector<std::string> summary_row(const ScenesResult& result, size_t method) {
  const MethodSummary sum = summary_of(result, method);
  return {result.methods[method].name,       concat(sum.right, " of ", sum.of),
          number_text(sum.worth_mean),       number_text(sum.worth_median),
          number_text(sum.worth_least),      number_text(sum.seconds.wall),
          number_text(sum.seconds.processor)};
}

const std::vector<std::string> kSummaryHead = {
    "method", "right", "worth: geo. mean", "median worth", "least worth", "seconds", "CPU s"};

TextRows summary_rows(const ScenesResult& result) {
  TextRows rows;
  for (size_t m = 0; m < result.methods.size(); ++m) rows.push_back(summary_row(result, m));
  return rows;
}

/// "0.98 6.1%", and " *" where it is right.
std::string scene_cell(const MethodOutcome& method) {
  const PairError& error = method.figures.irradiance;
  if (!is_measured(method) || !error.measured()) return "-";
  return formatted("%.2f %.3g%%%s", error.mean_ratio, 100 * error.block_error,
                   error.is_right() ? " *" : "  ");
}

/// What is said beside a scene.
std::vector<std::string> remarks_of(const ScenesResult& result, const SceneOutcome& scene) {
  std::vector<std::string> out = scene.notes;
  for (size_t m = 0; m < scene.methods.size(); ++m) {
    if (!is_measured(scene.methods[m]))
      out.push_back(result.methods[m].name + " not measured: " + scene.methods[m].not_measured);
  }
  return out;
}

/// Columns as wide as their widest cell; the first set to the left.
std::string text_table(const TextRows& rows) {
  std::vector<size_t> widths;
  for (const auto& row : rows) {
    widths.resize(std::max(widths.size(), row.size()));
    for (size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], row[c].size());
  }
  std::string out;
  for (const auto& row : rows) {
    std::string line;
    for (size_t c = 0; c < row.size(); ++c) {
      const std::string space(widths[c] - row[c].size(), ' ');
      line += (c > 0 ? "  " : "") + (c > 0 ? space + row[c] : row[c] + space);
    }
    line.erase(line.find_last_not_of(' ') + 1);
    out += line + "\n";
  }
  return out;
}

TextRows scene_rows(const ScenesResult& result) {
  std::vector<std::string> head = {"indirect irradiance: mean ratio, blocks"};
  for (size_t m = 0; m < result.methods.size(); ++m) head.push_back(concat("(", m + 1, ")  "));
  TextRows rows = {head};
  for (const size_t i : worst_first(result)) {
    const SceneOutcome& scene = result.scenes[i];
    if (!scene.error.empty()) continue;
    std::vector<std::string> row = {scene.name};
    for (const MethodOutcome& method : scene.methods) row.push_back(scene_cell(method));
    rows.push_back(row);
  }
  return rows;
}

std::string headline(const ScenesResult& result) {
  int measured = 0;
  for (const SceneOutcome& scene : result.scenes) measured += scene.error.empty() ? 1 : 0;
  const auto refused = static_cast<int>(result.scenes.size()) - measured;
  std::string out = concat(measured, measured == 1 ? " scene" : " scenes", " measured");
  if (refused > 0) out += concat(", ", refused, " refused or dark");
  if (result.parts > 0) out += concat("; ", result.parts, " files are parts of other scenes");
  return out;
}

nlohmann::json summary_json(const ScenesResult& result, size_t index) {
  const SceneMethod& method = result.methods[index];
  const MethodSummary sum = summary_of(result, index);
  nlohmann::json out{{"name", method.name},
                     {"settings", method.settings},
                     {"right", sum.right},
                     {"of", sum.of},
                     {"worth",
                      {{"geometric_mean", json_number(sum.worth_mean)},
                       {"median", json_number(sum.worth_median)},
                       {"least", json_number(sum.worth_least)}}},
                     {"seconds_median", json_number(sum.seconds.wall)},
                     {"processor_seconds_median", json_number(sum.seconds.processor)}};
  if (method.model != nullptr) out["checkpoint"] = method.model->file;
  return out;
}

nlohmann::json scene_json(const ScenesResult& result, const SceneOutcome& scene) {
  nlohmann::json out{{"name", scene.name}, {"notes", scene.notes}};
  out["error"] = scene.error.empty() ? nlohmann::json() : nlohmann::json(scene.error);
  if (!scene.camera.empty()) {
    out["camera"] = nlohmann::json::parse(scene.camera);
    out["camera_from"] = scene.camera_from;
    out["triangles"] = scene.triangles;
  }
  out["methods"] = nlohmann::json::object();
  for (size_t m = 0; m < scene.methods.size(); ++m) {
    const MethodOutcome& method = scene.methods[m];
    out["methods"][result.methods[m].name] =
        is_measured(method) ? figures_json(method.figures)
                            : nlohmann::json{{"not_measured", method.not_measured}};
  }
  return out;
}

std::span<const unsigned char> bytes_of(const std::string& png) {
  return {reinterpret_cast<const unsigned char*>(png.data()), png.size()};
}

std::string caption_of(const SceneMethod& method, const MethodFigures& figures) {
  const PairError &irradiance = figures.irradiance, &whole = figures.whole;
  return concat(method.name, irradiance.is_right() ? " (right)" : "", ": indirect ",
                number_text(irradiance.mean_ratio), ", blocks ",
                percent_text(irradiance.block_error), ", worth ", worth_text(irradiance),
                "; whole ", number_text(whole.mean_ratio), ", blocks ",
                percent_text(whole.block_error), ", FLIP ", number_text(figures.flip), "; ",
                number_text(figures.seconds.wall), " s");
}

TextRows figure_rows(const ScenesResult& result, const SceneOutcome& scene) {
  TextRows rows;
  for (size_t m = 0; m < scene.methods.size(); ++m) {
    if (!is_measured(scene.methods[m])) continue;
    const MethodFigures& f = scene.methods[m].figures;
    rows.push_back({result.methods[m].name, number_text(f.irradiance.mean_ratio),
                    percent_text(f.irradiance.block_error), number_text(f.irradiance.mse),
                    worth_text(f.irradiance), number_text(f.whole.mean_ratio),
                    percent_text(f.whole.block_error), number_text(f.whole.mse),
                    worth_text(f.whole), number_text(f.flip), number_text(f.ssim),
                    number_text(f.seconds.wall), number_text(f.seconds.processor)});
  }
  return rows;
}

std::string scene_html(const ScenesResult& result, const SceneOutcome& scene) {
  std::string out = "<h2>" + html_escape(scene.name) + "</h2>\n";
  for (const std::string& remark : remarks_of(result, scene)) out += html_note(remark);
  std::string pictures;
  if (!scene.png.empty()) pictures = html_picture(bytes_of(scene.png), "reference");
  for (size_t m = 0; m < scene.methods.size(); ++m) {
    const MethodOutcome& method = scene.methods[m];
    if (is_measured(method) && !method.png.empty())
      pictures += html_picture(bytes_of(method.png), caption_of(result.methods[m], method.figures));
  }
  out += html_grid(pictures);
  out += html_details(
      concat("Figures; camera: ", scene.camera_from, ", ", scene.triangles, " triangles"),
      html_table({"method", "indirect: ratio", "blocks", "MSE", "worth", "whole: ratio", "blocks",
                  "MSE", "worth", "FLIP", "SSIM", "s", "CPU s"},
                 figure_rows(result, scene)));
  return out;
}

TextRows refused_rows(const ScenesResult& result) {
  TextRows rows;
  for (const SceneOutcome& scene : result.scenes) {
    if (!scene.error.empty()) rows.push_back({scene.name, scene.error});
  }
  return rows;
}

}  // namespace

std::string scenes_table(const ScenesResult& result) {
  TextRows rows = {kSummaryHead};
  for (size_t m = 0; m < result.methods.size(); ++m) {
    rows.push_back(summary_row(result, m));
    rows.back()[0] = concat("(", m + 1, ") ", rows.back()[0]);
  }
  std::string out = text_table(rows) + kRightText + "\n\n" + text_table(scene_rows(result));
  for (const SceneOutcome& scene : result.scenes) {
    if (!scene.error.empty()) out += scene.name + ": not measured: " + scene.error + "\n";
    for (const std::string& remark : remarks_of(result, scene))
      out += scene.name + ": " + remark + "\n";
  }
  return out + headline(result) + "\n";
}

std::string scenes_json(const ScenesResult& result, const ScenesOptions& options) {
  nlohmann::json out{{"version", version()},
                     {"size", {options.width, options.height}},
                     {"reference_spp", options.reference_paths},
                     {"max_depth", options.max_depth},
                     {"seed", options.seed},
                     {"parts_left_out", result.parts},
                     {"methods", nlohmann::json::array()},
                     {"scenes", nlohmann::json::array()}};
  for (size_t m = 0; m < result.methods.size(); ++m)
    out["methods"].push_back(summary_json(result, m));
  for (const SceneOutcome& scene : result.scenes)
    out["scenes"].push_back(scene_json(result, scene));
  return out.dump(2) + "\n";
}

std::string scenes_html(const ScenesResult& result, const ScenesOptions& options) {
  std::string body = html_headline(headline(result));
  body += html_note(concat("lte ", version(), ", ", options.width, "x", options.height,
                           ", two references of ", options.reference_paths,
                           " paths a pixel each, seed ", options.seed, "."));
  body += html_table(kSummaryHead, summary_rows(result)) + html_note(kRightText);
  TextRows meanings;
  for (const SceneMethod& method : result.methods)
    meanings.push_back({method.name, method.settings});
  body += html_details("What the methods are", html_text_table({"method", "is"}, meanings));
  if (const TextRows refused = refused_rows(result); !refused.empty())
    body += "<h2>Not measured</h2>\n" + html_text_table({"scene", "why"}, refused);
  body += html_note(
      "Pictures: the whole picture and indirect irradiance, exposed as the reference, the scene "
      "with the largest error of the first method first. Ratio: mean over the reference's mean. "
      "Blocks: root mean square error of means over 8x8 pixels, over that mean. Worth: paths a "
      "pixel of equal error. The references' noise is in none of them (docs/metrics.md).");
  for (const size_t i : worst_first(result)) {
    if (result.scenes[i].error.empty()) body += scene_html(result, result.scenes[i]);
  }
  return html_page("Scenes of other people", body);
}

}  // namespace lte::infer
