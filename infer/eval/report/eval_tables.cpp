#include <cmath>

#include "infer/eval/report/eval_report.h"
#include "lte/base/check.h"
#include "lte/base/text.h"

namespace lte::infer {
namespace {

std::string bounds(const Interval& interval) {
  if (std::isnan(interval.low)) return "-";
  return concat(figure(interval.low), " to ", figure(interval.high));
}

/// Formats a path count, which is infinite where the error lies below the noise of the reference.
std::string paths(double value) { return std::isinf(value) ? "all of them" : figure(value); }

}  // namespace

const char* const kPaperNote =
    "The paper's MSE and SSIM are of irradiance without texture, as here, but on 105 scenes of its "
    "own, in its own unit of light and with its own display values, none of which are published: "
    "columns of one row can be compared, rows of the paper and rows of this evaluation cannot.";

std::string scene_count(const EvalResult& result) {
  const size_t scenes = result.scenes.size();
  return concat(scenes, scenes == 1 ? " scene" : " scenes");
}

std::string figure(double value) {
  if (!std::isfinite(value)) return "-";
  return formatted("%.4g", value);
}

TextTable sample_table(const EvalResult& result) {
  TextTable out;
  const std::string percent = concat(std::lround(100 * result.bootstrap.level), " %");
  out.head = {"worth path-traced samples",
              "a point",
              percent,
              "median scene",
              "a pixel",
              percent,
              "median scene"};
  for (const PredictorSamples& entry : result.equal_samples) {
    out.rows.push_back({entry.name, paths(entry.points.all), bounds(entry.points.interval),
                        paths(entry.points.median), paths(entry.views.all),
                        bounds(entry.views.interval), paths(entry.views.median)});
  }
  return out;
}

std::string sample_note(const EvalResult& result) {
  if (std::isnan(result.variance_check.ratio)) return "";
  // SSIM does not follow from that of 64 paths.
  const Score* const few = find_score(result.mean, concat("path_tracing_", data::kFewPaths[0]));
  const bool traced = few && std::isfinite(few->views[2]);
  const double exponent = result.variance_check.exponent;  // NaN where two counts are too few
  return concat(
      "From the MSE of path tracing with 64 paths, whose variance falls as 1/n. Here ",
      std::isfinite(exponent)
          ? concat("it falls as 1/n^", figure(exponent), " between 64 paths and the reference's: ")
          : "",
      "one path has ", figure(result.variance_check.ratio),
      " times the variance that the spread of the reference tells. Rows of 16, 4 and 1 path are ",
      traced ? "derived at points, and traced in views." : "derived, not traced.");
}

TextTable paper_table(const EvalResult& result) {
  TextTable out;
  out.head = {"views", "network: MSE", "SSIM", "path tracing, 64 paths: MSE", "SSIM"};
  const Score missing;
  const auto score = [&](const char* name) {
    const Score* const found = find_score(result.mean, name);
    return found ? *found : missing;
  };
  const Score own = score("neural"), path_traced = score(kPathTraced);
  out.rows.push_back({concat(scene_count(result), " here"), figure(own.views[0]),
                      figure(own.views[2]), figure(path_traced.views[0]),
                      figure(path_traced.views[2])});
  out.rows.push_back({"105 scenes of the paper", "0.048", "0.912", "0.051", "0.425"});
  return out;
}

}  // namespace lte::infer
