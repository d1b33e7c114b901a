#include "train/command/report_command.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "lte/base/check.h"
#include "lte/base/config.h"
#include "lte/base/file.h"
#include "lte/base/text.h"
#include "lte/cli/command_files.h"
#include "lte/report/chart.h"
#include "lte/report/html.h"
#include "train/command/report_log.h"
#include "train/command/run_files.h"
#include "train/log/run_log.h"

namespace lte::train {
namespace {

namespace fs = std::filesystem;

constexpr size_t kWorstScenes = 6, kLines = 6;
constexpr double kRisen = 1.05;  // a validation loss this far above its lowest is worth a warning

// Short forms of docs/training-run.md, for a reader who has the page alone.
const std::vector<std::vector<std::string>> kMeanings = {
    {"loss", "relative error of log(x + 1) of irradiance over the mean emission", "lower"},
    {"MSE", "mean squared error of the same", "lower"},
    {"relative MSE", "mean of the squared error over the squared reference", "lower"},
    {"PSNR", "MSE in dB, against the scene's largest reference value", "higher"},
    {"mean error over mean", "bias: above 0 too bright, below 0 too dark", "0"},
    {"gradient norm", "before clipping; spikes are steps that training survived by clipping", ""}};

std::string number(double value) { return formatted("%.4g", value); }

std::string duration(double seconds) {
  const auto whole = std::llround(seconds);
  return formatted("%lld:%02lld:%02lld h", whole / 3600, whole / 60 % 60, whole % 60);
}

double last(const Series& series) { return series.empty() ? 0 : series.back().second; }

double sum(const Series& series) {
  double out = 0;
  for (const auto& point : series) out += point.second;
  return out;
}

/// Step and value of the lowest validation loss.
std::pair<double, double> lowest(const Series& series) {
  return *std::min_element(series.begin(), series.end(),
                           [](const auto& a, const auto& b) { return a.second < b.second; });
}

std::string headline(const RunHistory& log, int64_t steps) {
  const Series &loss = log.figure("val_loss"), &psnr = log.figure("val_psnr");
  std::string out =
      loss.empty() ? concat("Training loss ", number(last(log.figure("loss"))), ", no validation")
                   : concat("Validation loss ", number(last(loss)));
  if (!psnr.empty()) out += concat(", PSNR ", number(last(psnr)), " dB");
  return concat(out, ", at step ", log.last_step, " of ", steps);
}

/// What the reader ought to know before the curves; empty if there is nothing.
std::string warning(const RunHistory& log) {
  const Series& loss = log.figure("val_loss");
  if (loss.empty()) return "";
  const auto [step, least] = lowest(loss);
  if (last(loss) <= kRisen * least) return "";
  return formatted(
      "The validation loss was lowest at step %.0f (%.4g) and has risen by %.0f %% since: more of "
      "the same training does not help other scenes.",
      step, least, 100 * (last(loss) / least - 1));
}

std::string loss_charts(const RunHistory& log) {
  std::string out = html_chart({.title = "loss", .x_label = "step", .log_y = true},
                               {{"training", log.figure("loss")},
                                {"validation", log.figure("val_loss")},
                                {"validation, median scene", log.figure("val_loss_median")}});
  out += html_chart({.title = "validation PSNR, dB", .x_label = "step"},
                    {{"", log.figure("val_psnr")}});
  out += html_chart({.title = "validation: error", .x_label = "step", .log_y = true},
                    {{"MSE", log.figure("val_mse")}, {"relative MSE", log.figure("val_relmse")}});
  out += html_chart({.title = "validation: mean error over mean", .x_label = "step"},
                    {{"", log.figure("val_bias")}});
  return html_grid(out);
}

std::string optimizer_charts(const RunHistory& log) {
  std::vector<ChartLine> norms = {{"whole gradient", log.figure("grad_norm")}};
  for (const auto& [name, series] : log.figures) {
    if (name.starts_with(kModuleNormPrefix))
      norms.push_back({name.substr(kModuleNormPrefix.size()), series});
  }
  return html_grid(
      html_chart({.title = "learning rate", .x_label = "step"}, {{"", log.figure("lr")}}) +
      html_chart({.title = "gradient norm before clipping", .x_label = "step", .log_y = true},
                 norms));
}

/// The lines of all figures whose names begin alike, named by the rest.
std::vector<ChartLine> lines_with(const RunHistory& log, const std::string& prefix) {
  std::vector<ChartLine> lines;
  for (const auto& [name, series] : log.figures) {
    if (name.starts_with(prefix)) lines.push_back({name.substr(prefix.size()), series});
  }
  return lines;
}

/// What the stages carry and whether all of the network moves; empty for logs without it.
std::string health_section(const RunHistory& log) {
  const auto chart = [&](const char* title, std::string_view prefix, const char* figure,
                         bool log_y) {
    const std::vector<ChartLine> lines = lines_with(log, concat(prefix, figure));
    if (lines.empty()) return std::string();
    return html_chart({.title = title, .x_label = "step", .log_y = log_y}, lines);
  };
  const std::string charts =
      chart("share of a stage's features that differs between points", kHealthPrefix, "varying_",
            false) +
      chart("entropy of attention over log n", kHealthPrefix, "entropy_", false) +
      chart("root mean square of a stage's features", kHealthPrefix, "rms_", true) +
      chart("movement of weights since the start, relative", kHealthPrefix, "moved_", true) +
      chart("root mean square of the gradient's entries", kModuleRmsPrefix, "", true);
  return charts.empty() ? "" : "<h2>Health</h2>\n" + html_grid(charts);
}

/// Scenes by their latest validation loss, the worst first.
std::vector<std::pair<double, std::string>> ranked(const RunHistory& log) {
  std::vector<std::pair<double, std::string>> out;
  for (const auto& [name, series] : log.scenes) out.emplace_back(last(series), name);
  std::sort(out.rbegin(), out.rend());
  return out;
}

std::string picture_section(const RunHistory& log, const fs::path& run) {
  std::string pictures;
  size_t shown = 0;
  for (const auto& [loss, name] : ranked(log)) {
    const fs::path picture = run / "previews" / (name + ".png");
    if (shown == kWorstScenes || !fs::exists(picture)) continue;
    const std::string png = read_file(picture);
    pictures += html_picture({reinterpret_cast<const unsigned char*>(png.data()), png.size()},
                             concat(name, ": validation loss ", number(loss)));
    ++shown;
  }
  if (shown == 0)
    return html_note("No pictures: no validation scene has a view, or train.preview_every is 0.");
  return html_note(
             "Reference | prediction | difference of luminance × 4; irradiance without "
             "albedo. The worst scenes first.") +
         html_grid(pictures);
}

std::string scene_section(const RunHistory& log) {
  const auto scenes = ranked(log);
  if (scenes.empty()) return html_note("No validation yet.");
  std::vector<std::vector<std::string>> rows;
  for (const auto& [loss, name] : scenes) {
    const Series& series = log.scenes.at(name);
    rows.push_back(
        {name, number(loss), number(lowest(series).second), number(series.front().second)});
  }
  std::vector<ChartLine> lines;
  for (size_t i = 0; i < std::min(kLines, scenes.size()); ++i)
    lines.push_back({scenes[i].second, log.scenes.at(scenes[i].second)});
  return html_grid(
      html_chart({.title = "validation loss of the worst scenes", .x_label = "step", .log_y = true},
                 lines) +
      html_details(concat("All ", scenes.size(), " validation scenes"),
                   html_table({"validation scene", "loss", "lowest", "first"}, rows)));
}

/// Hours of training, over steps.
Series hours_of(const RunHistory& log) {
  Series hours = log.figure("seconds");
  for (auto& point : hours) point.second /= 3600;
  return hours;
}

std::string time_section(const RunHistory& log, int64_t steps) {
  const double total = last(log.figure("seconds"));
  const double validation = sum(log.figure("val_seconds")),
               previews = sum(log.figure("preview_seconds"));
  const double done = static_cast<double>(log.last_step);
  std::vector<std::vector<std::string>> rows = {
      {"all sessions", duration(total)},
      {"of it validation", duration(validation)},
      {"of it pictures", duration(previews)},
      {"a step, all in all", done > 0 ? number(total / done) + " s" : "-"}};
  if (steps > log.last_step && done > 0)
    rows.push_back(
        {"left at this rate", duration(total / done * (static_cast<double>(steps) - done))});
  rows.push_back({"resident memory", number(last(log.figure("rss_mb"))) + " MiB"});
  return html_table({"time", ""}, rows) +
         html_grid(
             html_chart({.title = "queries a second", .x_label = "step"},
                        {{"", log.figure("queries_per_s")}}) +
             html_chart({.title = "hours of training", .x_label = "step"}, {{"", hours_of(log)}}));
}

}  // namespace

CLI::App* add_report_command(CLI::App& app, ReportOptions* options) {
  auto* report =
      app.add_subcommand("report", "Write a run's curves, scenes and times as one HTML page");
  report->add_option("RUN", options->run, "Run directory")->required();
  report->add_option("--out", options->out, "The page; by default RUN/report.html");
  return report;
}

std::string write_run_report(const fs::path& run, fs::path out) {
  CommandFiles files;
  files.reads_parts("RUN", run, kRunParts);
  files.writes("--out", out);
  files.check();
  const fs::path yaml = run / "config.yaml", log_path = run / "log.jsonl";
  LTE_CHECK(fs::is_directory(run), run.string(), ": no such run directory");
  const RunHistory log = read_run_log(log_path);
  int64_t steps = 0;
  const std::string config = read_file(yaml);
  Config::parse(config, yaml.string()).at("train").read("steps", &steps);
  std::string body = html_headline(headline(log, steps)) + html_warning(warning(log));
  body += "<p class=note><a href=\"#meaning\">What the figures mean</a></p>\n";
  body += "<h2>Pictures</h2>\n" + picture_section(log, run);
  body += "<h2>Error</h2>\n" + loss_charts(log);
  body += "<h2>Scenes</h2>\n" + scene_section(log);
  body += "<h2>Optimization</h2>\n" + optimizer_charts(log);
  body += health_section(log);
  body += "<h2>Time</h2>\n" + time_section(log, steps);
  body += "<h2>Configuration</h2>\n" +
          html_details("config.yaml", concat("<pre>", html_escape(config), "</pre>\n"));
  body += "<h2 id=meaning>What the figures mean</h2>\n" +
          html_text_table({"name", "meaning", "better"}, kMeanings) +
          html_note("The same in full: docs/training-run.md of lte.");
  if (out.empty()) out = run / "report.html";
  write_file(out, html_page("Training run " + fs::absolute(run).lexically_normal().string(), body));
  return concat(out.string(), ": step ", log.last_step, " of ", steps, "\n");
}

}  // namespace lte::train
