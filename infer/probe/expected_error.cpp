#include "infer/probe/expected_error.h"

#include <algorithm>
#include <cmath>

namespace lte::infer {
namespace {

// The spread over all points counts as much as so many tables at the point itself.
constexpr double kTablesOfOthers = 3;

double mean_square(const Rgb& value) { return double{dot(value, value)} / 3; }

/// Squared, relative to the light.
double squared_fault(const LightCheck& check, size_t point) {
  if (check.region_of.empty()) return 0;
  return check.regions[static_cast<size_t>(check.region_of[point])].expected_square +
         check.variance;
}

}  // namespace

double rms(const Rgb& value) { return std::sqrt(mean_square(value)); }

std::vector<double> expected_errors(const GatheredProbe& gathered,
                                    std::span<const Rgb> direct_error, const LightCheck& check) {
  double squares = 0, light = 0;
  for (size_t i = 0; i < gathered.indirect.size(); ++i) {
    squares += mean_square(gathered.standard_error[i]);
    light += mean_square(gathered.indirect[i]);
  }
  const double relative = light > 0 ? squares / light : 0;
  const double own = gathered.tables - 1;
  std::vector<double> out;
  out.reserve(gathered.indirect.size());
  for (size_t i = 0; i < gathered.indirect.size(); ++i) {
    const double here = mean_square(gathered.indirect[i]);
    const double spread =
        (own * mean_square(gathered.standard_error[i]) + kTablesOfOthers * relative * here) /
        (own + kTablesOfOthers);
    const double fault = (squared_fault(check, i) + kUnseenShare * kUnseenShare) * here;
    out.push_back(std::sqrt(spread + fault + mean_square(direct_error[i])));
  }
  return out;
}

}  // namespace lte::infer
