#include <cmath>

#include "infer/eval/report/eval_report.h"
#include "lte/base/check.h"
#include "lte/base/text.h"

namespace lte::infer {
namespace {

constexpr size_t kMse = 0;  // in both lists of metrics

/// MSE of the network over that of constant_mean; NaN where one of them could not be measured.
struct OverConstant {
  double points = std::nan(""), views = std::nan("");
};

OverConstant over_constant(const EvalResult& result) {
  const Score* const network = find_score(result.mean, "neural");
  const Score* const constant = find_score(result.mean, "constant_mean");
  if (!network || !constant) return {};
  return {network->points[kMse] / constant->points[kMse],
          network->views[kMse] / constant->views[kMse]};
}

std::string rounded(double samples) {
  if (std::isinf(samples)) return "all";
  return formatted(samples < 10 ? "%.2g" : "%.0f", samples);
}

/// "65 path-traced samples a pixel (95 %: 49 to 86)"; "" if it could not be measured.
std::string worth(const EvalResult& result, const EqualSamples& samples, const char* unit) {
  if (std::isnan(samples.all)) return "";
  std::string out = concat(rounded(samples.all), " path-traced samples ", unit);
  if (!std::isnan(samples.interval.low)) {
    out += concat(" (", interval_level(result), ": ", rounded(samples.interval.low), " to ",
                  rounded(samples.interval.high), ")");
  }
  return out;
}

/// "0.41 times that at points, 0.4 times that in views"
std::string shares(const OverConstant& ratio) {
  std::string out;
  if (!std::isnan(ratio.points))
    out = concat(formatted("%.3g", ratio.points), " times that at points");
  if (!std::isnan(ratio.views)) {
    out += concat(out.empty() ? "" : ", ", formatted("%.3g", ratio.views), " times that in views");
  }
  return out;
}

}  // namespace

std::string interval_level(const EvalResult& result) {
  return concat(std::lround(100 * result.bootstrap.level), " %");
}

std::string eval_headline(const EvalResult& result) {
  for (const PredictorSamples& entry : result.equal_samples) {
    if (entry.name != "neural") continue;
    const std::string pixel = worth(result, entry.views, "a pixel"),
                      point = worth(result, entry.points, "a point");
    if (pixel.empty() && point.empty()) break;
    const char* const both = pixel.empty() || point.empty() ? "" : " and ";
    return concat("Worth ", pixel, both, point, ".");
  }
  const Score* const network = find_score(result.mean, "neural");
  if (!network) return "Nothing was measured.";
  return concat("Mean squared error ", figure(network->points[kMse]), " at points, ",
                figure(network->views[kMse]), " in views.");
}

bool worse_than_constant(const EvalResult& result) {
  const OverConstant ratio = over_constant(result);
  return ratio.points > 1 || ratio.views > 1;
}

std::string eval_verdict(const EvalResult& result) {
  const std::string found = shares(over_constant(result));
  if (found.empty()) return "";
  if (worse_than_constant(result)) {
    return concat(
        "Worse than a constant: constant_mean answers the same everywhere, and the "
        "network's error (MSE) is ",
        found, ". Do not use this model on such scenes.");
  }
  return concat(
      "Better than a constant: constant_mean answers the same everywhere, and the "
      "network's error (MSE) is ",
      found, ".");
}

}  // namespace lte::infer
