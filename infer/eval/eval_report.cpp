#include "infer/eval/eval_report.h"

#include <cmath>

#include "lte/base/check.h"
#include "lte/base/file.h"
#include "lte/base/text.h"
#include "lte/report/html.h"

namespace lte::infer {
namespace {

constexpr int kColumn = 10;

std::string line(const std::string& name, const Score& score) {
  std::string out = formatted("%-28.28s", name.c_str());
  const auto cell = [&](double value) { return formatted("%*s", kColumn, figure(value).c_str()); };
  for (const double value : score.points) out += cell(value);
  out += "  |";
  for (const double value : score.views) out += cell(value);
  return out + '\n';
}

std::string head(const std::string& title) {
  std::string out = formatted("%-28.28s", title.c_str());
  for (const char* name : kPointMetrics) out += formatted("%*s", kColumn, name);
  out += "  |";
  for (const char* name : kViewMetrics) out += formatted("%*s", kColumn, name);
  return out + '\n';
}

std::string block(const std::string& title, const Scores& scores) {
  std::string out = head(title);
  for (const auto& [name, score] : scores) out += line("  " + name, score);
  return out;
}

std::string percent(const EvalResult& result) {
  return concat(std::lround(100 * result.bootstrap.level), " %");
}

std::string mean_block(const EvalResult& result) {
  std::string out = head("mean over scenes");
  for (size_t i = 0; i < result.mean.size(); ++i) {
    const auto& [name, score] = result.mean[i];
    const ScoreInterval& bounds = result.mean_interval[i].second;
    out += line("  " + name, score);
    out += line(concat("    ", percent(result), ", from"), bounds.low);
    out += line("           to", bounds.high);
  }
  return out;
}

std::string plain(const TextTable& table) {
  std::vector<size_t> widths;
  for (size_t column = 0; column < table.head.size(); ++column) {
    size_t width = table.head[column].size();
    for (const auto& row : table.rows) width = std::max(width, row[column].size());
    widths.push_back(width);
  }
  const auto text = [&](const std::vector<std::string>& row) {
    std::string out = formatted("%-*s", static_cast<int>(widths[0]), row[0].c_str());
    for (size_t i = 1; i < row.size(); ++i)
      out += formatted("  %*s", static_cast<int>(widths[i]), row[i].c_str());
    return out + '\n';
  };
  std::string out = text(table.head);
  for (const auto& row : table.rows) out += text(row);
  return out;
}

std::vector<std::string> metric_head(const std::string& title) {
  std::vector<std::string> out = {title};
  for (const char* name : kPointMetrics) out.push_back(concat("points ", name));
  for (const char* name : kViewMetrics) out.push_back(concat("views ", name));
  return out;
}

/// `cell` makes the text of a predictor's figure from a member of Score and an index.
template <typename Cell>
std::vector<std::string> metric_row(const std::string& name, const Cell& cell) {
  std::vector<std::string> out = {name};
  for (size_t k = 0; k < kPointMetrics.size(); ++k) out.push_back(cell(&Score::points, k));
  for (size_t k = 0; k < kViewMetrics.size(); ++k) out.push_back(cell(&Score::views, k));
  return out;
}

std::string html_block(const std::string& title, const Scores& scores,
                       const ScoreIntervals* intervals) {
  std::vector<std::vector<std::string>> rows;
  for (size_t i = 0; i < scores.size(); ++i) {
    const Score& score = scores[i].second;
    rows.push_back(metric_row(scores[i].first, [&](auto member, size_t metric) {
      const std::string value = figure((score.*member)[metric]);
      if (!intervals || value == "-") return value;
      const ScoreInterval& bounds = (*intervals)[i].second;
      return concat(value, " (", figure((bounds.low.*member)[metric]), "–",
                    figure((bounds.high.*member)[metric]), ")");
    }));
  }
  return html_table(metric_head(title), rows, "neural");
}

std::string html_note(const std::string& text) {
  return text.empty() ? "" : concat("<p class=note>", html_escape(text), "</p>\n");
}

std::span<const unsigned char> bytes_of(const std::string& text) {
  return {reinterpret_cast<const unsigned char*>(text.data()), text.size()};
}

}  // namespace

std::string eval_table(const EvalResult& result) {
  std::string out = formatted(
      "%zu scenes of split %s; indirect irradiance over the emission scalar; points | views\n\n",
      result.scenes.size(), result.split.c_str());
  for (const SceneResult& scene : result.scenes) out += block(scene.name, scene.scores);
  out += '\n' + block("median over scenes", result.median) + '\n' + mean_block(result);
  if (!result.equal_samples.empty())
    out += '\n' + plain(sample_table(result)) + sample_note(result) + '\n';
  return out + '\n' + plain(paper_table(result)) + kPaperNote + '\n';
}

std::string eval_csv(const EvalResult& result) {
  std::string out = "scene,predictor";
  for (const char* name : kPointMetrics) out += formatted(",points_%s", name);
  for (const char* name : kViewMetrics) out += formatted(",views_%s", name);
  out += '\n';
  const auto field = [](double value) {
    return std::isfinite(value) ? formatted(",%.9g", value) : std::string(",");
  };
  for (const SceneResult& scene : result.scenes) {
    for (const auto& [name, score] : scene.scores) {
      out += scene.name + ',' + name;
      for (const double value : score.points) out += field(value);
      for (const double value : score.views) out += field(value);
      out += '\n';
    }
  }
  return out;
}

std::string eval_html(const EvalResult& result, const std::string& checkpoint,
                      const std::string& data, const ContactSheets& sheets) {
  std::string body = html_note(concat(
      "Model ", checkpoint, "; data ", data,
      ". Indirect irradiance over the emission scalar; formulas in docs/metrics.md. Brackets: ",
      percent(result), " confidence over scenes, ", result.bootstrap.resamples,
      " bootstrap resamples of seed ", result.bootstrap.seed, "."));
  body += "<h2>Error</h2>\n" + html_block("mean over scenes", result.mean, &result.mean_interval) +
          html_block("median over scenes", result.median, &result.median_interval);
  if (!result.equal_samples.empty()) {
    const TextTable samples = sample_table(result);
    body += "<h2>Worth how many path-traced samples</h2>\n" +
            html_table(samples.head, samples.rows, "neural") + html_note(sample_note(result));
  }
  const TextTable paper = paper_table(result);
  body +=
      "<h2>Beside the paper</h2>\n" + html_table(paper.head, paper.rows) + html_note(kPaperNote);
  body += "<h2>Scenes</h2>\n";
  for (const SceneResult& scene : result.scenes)
    body += html_block(scene.name, scene.scores, nullptr);
  body += "<h2>Views</h2>\n" + html_note(kSheetColumns);
  for (const std::string& scene : sheets.scenes())
    body += html_picture(bytes_of(read_file(sheets.path(scene))), scene);
  return html_page(
      concat("Evaluation on ", result.scenes.size(), " scenes of split ", result.split), body);
}

}  // namespace lte::infer
