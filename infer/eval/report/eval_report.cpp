#include "infer/eval/report/eval_report.h"

#include <algorithm>

#include "lte/base/check.h"
#include "lte/base/text.h"

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

std::string mean_block(const EvalResult& result) {
  std::string out = head("mean over scenes");
  for (size_t i = 0; i < result.mean.size(); ++i) {
    const auto& [name, score] = result.mean[i];
    const ScoreInterval& bounds = result.mean_interval[i].second;
    out += line("  " + name, score);
    out += line(concat("    ", interval_level(result), ", from"), bounds.low);
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

}  // namespace

std::string eval_table(const EvalResult& result) {
  std::string out =
      formatted("%s of split %s; indirect irradiance over the emission scalar; points | views\n\n",
                scene_count(result).c_str(), result.split.c_str());
  for (const SceneResult& scene : result.scenes) out += block(scene.name, scene.scores);
  if (result.scenes.size() > 1)  // the median and the mean of one scene are that scene
    out += '\n' + block("median over scenes", result.median) + '\n' + mean_block(result);
  if (!result.equal_samples.empty())
    out += '\n' + plain(sample_table(result)) + sample_note(result) + '\n';
  out += '\n' + plain(paper_table(result)) + kPaperNote + "\n\n";
  return out + eval_headline(result) + '\n' + eval_verdict(result) + '\n';
}

}  // namespace lte::infer
