#include <cmath>
#include <span>

#include "infer/eval/report/eval_report.h"
#include "lte/base/check.h"
#include "lte/base/file.h"
#include "lte/report/html.h"

namespace lte::infer {
namespace {

using Rows = std::vector<std::vector<std::string>>;

// Short forms of docs/metrics.md, for a reader who has the page alone.
const Rows kMeanings = {
    {"mse", "mean squared error of irradiance over the mean emission", "lower"},
    {"psnr", "the same in dB, against the 99th percentile of the reference", "higher"},
    {"relmse", "mean of the squared error over the squared reference", "lower"},
    {"logrel",
     "the training loss with the reference in the denominator: relative error of log(x + 1)",
     "lower"},
    {"ssim", "structural similarity of the pictures, at most 1", "higher"},
    {"flip", "visible difference of displayed pictures, 0 to 1 (NVIDIA FLIP)", "lower"},
    {"hdrflip", "the same over a range of exposures", "lower"},
    {"worth n samples", "path tracing with n paths has the same MSE", "higher"},
    {"path_tracing_n", "n paths a point or pixel", ""},
    {"path_tracing_n_denoised", "the same in views, by Open Image Denoise where it is found", ""},
    {"neural_and_n_denoised", "the network's view combined with that", ""},
    {"light_cache", "the light that the network starts from, interpolated, without the network",
     ""},
    {"constant_mean", "the mean irradiance of the training scenes, everywhere", ""}};

/// One table of point metrics or of view metrics.
template <typename Metrics, typename Member>
std::string metric_table(const std::string& title, const Scores& scores,
                         const ScoreIntervals* intervals, const Metrics& metrics, Member member) {
  std::vector<std::string> head = {title};
  head.insert(head.end(), metrics.begin(), metrics.end());
  Rows rows;
  for (size_t i = 0; i < scores.size(); ++i) {
    std::vector<std::string> row = {scores[i].first};
    for (size_t k = 0; k < metrics.size(); ++k) {
      std::string cell = figure((scores[i].second.*member)[k]);
      if (intervals) {
        const ScoreInterval& bounds = (*intervals)[i].second;
        const double low = (bounds.low.*member)[k], high = (bounds.high.*member)[k];
        if (!std::isnan(low)) cell += concat(" (", figure(low), "–", figure(high), ")");
      }
      row.push_back(cell);
    }
    rows.push_back(row);
  }
  return html_table(head, rows, "neural");
}

std::string metric_tables(const std::string& title, const Scores& scores,
                          const ScoreIntervals* intervals) {
  return metric_table(title + ", at points", scores, intervals, kPointMetrics, &Score::points) +
         metric_table(title + ", in views", scores, intervals, kViewMetrics, &Score::views);
}

std::string pictures(const ContactSheets& sheets) {
  if (sheets.scenes().empty()) return html_note("The data has no views, so there are no pictures.");
  std::string out = html_note(concat("Indirect irradiance, a row a view: ", kSheetColumns, "."));
  for (const std::string& scene : sheets.scenes()) {
    const std::string png = read_file(sheets.path(scene));
    out += html_picture({reinterpret_cast<const unsigned char*>(png.data()), png.size()}, scene);
  }
  return out;
}

std::string interval_note(const EvalResult& result) {
  if (result.scenes.size() < 2) return "One scene says nothing about others: no intervals.";
  return concat("Brackets: ", interval_level(result), " confidence over scenes, ",
                result.bootstrap.resamples, " bootstrap resamples of seed ", result.bootstrap.seed,
                ".");
}

std::string tables(const EvalResult& result) {
  std::string out;
  if (!result.equal_samples.empty()) {
    const TextTable samples = sample_table(result);
    out += "<h2>Worth how many path-traced samples</h2>\n" +
           html_table(samples.head, samples.rows, "neural") + html_note(sample_note(result));
  }
  out += "<h2>Error</h2>\n" + html_note(interval_note(result)) +
         metric_tables("mean over scenes", result.mean, &result.mean_interval);
  if (result.scenes.size() > 1) {
    out += html_details("Median over scenes",
                        metric_tables("median", result.median, &result.median_interval));
    std::string scenes;
    for (const SceneResult& scene : result.scenes)
      scenes += metric_tables(scene.name, scene.scores, nullptr);
    out += html_details("Scene by scene", scenes);
  }
  const TextTable paper = paper_table(result);
  return out + "<h2>Beside the paper</h2>\n" + html_table(paper.head, paper.rows) +
         html_note(kPaperNote);
}

}  // namespace

std::string eval_html(const EvalResult& result, const std::string& checkpoint,
                      const std::string& data, const ContactSheets& sheets) {
  const std::string verdict = eval_verdict(result);
  std::string body = html_headline(eval_headline(result));
  body += worse_than_constant(result) ? html_warning(verdict) : html_note(verdict);
  body += html_note(concat("Model ", checkpoint, "; data ", data,
                           ". Indirect irradiance over the mean emission."));
  body += "<p class=note><a href=\"#meaning\">What the figures mean</a></p>\n";
  body += "<h2>Pictures</h2>\n" + pictures(sheets) + tables(result);
  body += "<h2 id=meaning>What the figures mean</h2>\n" +
          html_text_table({"name", "meaning", "better"}, kMeanings) +
          html_note("Formulas and the predictors in full: docs/metrics.md of lte.");
  return html_page(concat("Evaluation on ", scene_count(result), " of split ", result.split), body);
}

}  // namespace lte::infer
