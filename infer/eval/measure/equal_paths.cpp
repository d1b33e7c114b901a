#include "infer/eval/measure/equal_paths.h"

#include <cmath>
#include <cstddef>
#include <iterator>
#include <string_view>

namespace lte::infer {
namespace {

/// Whether a metric is no error: PSNR, a logarithm already, and SSIM, which ends at 1.
bool is_likeness(std::string_view metric) { return metric == "psnr" || metric == "ssim"; }

double between(double a, double b, double share) { return a + share * (b - a); }

}  // namespace

std::optional<ViewScore> score_between(const std::map<int, ViewScore>& measured, double paths) {
  const auto at_least = measured.lower_bound(static_cast<int>(std::ceil(paths)));
  if (at_least == measured.end()) return std::nullopt;
  if (at_least->first == paths) return at_least->second;
  if (at_least == measured.begin()) return std::nullopt;
  const auto& [fewer, low] = *std::prev(at_least);
  const auto& [more, high] = *at_least;
  const double share = std::log(paths / fewer) / std::log(static_cast<double>(more) / fewer);
  ViewScore out;
  for (size_t k = 0; k < out.size(); ++k) {
    const bool straight = is_likeness(kViewMetrics[k]) || low[k] <= 0 || high[k] <= 0;
    out[k] = straight ? between(low[k], high[k], share)
                      : std::exp(between(std::log(low[k]), std::log(high[k]), share));
  }
  return out;
}

}  // namespace lte::infer
