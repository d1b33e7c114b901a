// An evaluation as JSON, as a table for people, and as files of a report folder.
#pragma once

#include <filesystem>
#include <string>

#include "infer/eval/evaluate.h"
#include "infer/eval/report/contact_sheet.h"

namespace lte::infer {

/// Makes the JSON whose keys docs/metrics.md explains. A figure that could not be measured is null.
/// `checkpoint` and `data` are recorded as given.
std::string eval_json(const EvalResult& result, const std::string& checkpoint,
                      const std::string& data);

/// Makes text for a terminal. It has every metric by predictor (scene by scene, median, and mean
/// with its confidence interval), what the errors are worth in path-traced samples, the paper's
/// table, and last the headline and the verdict.
std::string eval_table(const EvalResult& result);

/// Makes a self-contained page: headline, verdict, sheets, then the tables of eval_table().
/// @throws lte::Error if a sheet cannot be read.
std::string eval_html(const EvalResult& result, const std::string& checkpoint,
                      const std::string& data, const ContactSheets& sheets);

/// "Worth 65 path-traced samples a pixel (95 %: 49 to 86) and 32 a point (..)", or the errors where
/// the data has no path-traced estimates. Of one scene without intervals.
std::string eval_headline(const EvalResult& result);

/// The network's MSE beside that of a constant, constant_mean. Begins with "Worse than a constant"
/// where the network's is the larger one, at points or in views.
std::string eval_verdict(const EvalResult& result);
/// Whether the verdict is that.
bool worse_than_constant(const EvalResult& result);

/// "95 %"
std::string interval_level(const EvalResult& result);

/// Rows for people: a title, then text cells.
struct TextTable {
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows;
};

/// Path-traced samples of equal error, by predictor; no rows without path_tracing_64.
TextTable sample_table(const EvalResult& result);

/// Table 1 of the paper beside the same figures here.
TextTable paper_table(const EvalResult& result);

/// Notes below those two tables.
std::string sample_note(const EvalResult& result);
extern const char* const kPaperNote;

/// "1 scene" or "10 scenes".
std::string scene_count(const EvalResult& result);

/// "0.0123", or "-" for what could not be measured.
std::string figure(double value);

}  // namespace lte::infer
