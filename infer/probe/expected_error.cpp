#include "infer/probe/expected_error.h"

#include <algorithm>
#include <cmath>

#include "lte/gi/expected_error.h"

namespace lte::infer {
namespace {

double mean_square(const Rgb& value) { return double{dot(value, value)} / 3; }

/// What rays share, squared, relative to the unit.
double shared_square(const LightCheck& check, size_t point) {
  if (check.region_of.empty()) return gi::kSharedError * gi::kSharedError;
  return check.regions[static_cast<size_t>(check.region_of[point])].expected_square;
}

}  // namespace

double rms(const Rgb& value) { return std::sqrt(mean_square(value)); }

gi::ErrorUnit error_unit(std::span<const Rgb> light) {
  double sum = 0;
  for (const Rgb& value : light) sum += rms(value);
  return gi::ErrorUnit(sum / static_cast<double>(std::max<size_t>(1, light.size())));
}

std::vector<double> expected_errors(const GatheredProbe& gathered,
                                    std::span<const Rgb> direct_error, const LightCheck& check) {
  const gi::ErrorUnit unit = error_unit(gathered.indirect);
  double squares = 0, units = 0;
  for (size_t i = 0; i < gathered.indirect.size(); ++i) {
    squares += mean_square(gathered.standard_error[i]);
    units += std::pow(unit(rms(gathered.indirect[i])), 2);
  }
  const double relative = units > 0 ? squares / units : 0;
  std::vector<double> out;
  out.reserve(gathered.indirect.size());
  for (size_t i = 0; i < gathered.indirect.size(); ++i) {
    const double here = std::pow(unit(rms(gathered.indirect[i])), 2);
    // A variance that so many tables tell has itself a variance: twice its square, over their
    // number less one. That of a normal error's square has no divisor; both are joined by these.
    const double spread =
        ((gathered.tables - 1) * mean_square(gathered.standard_error[i]) + relative * here) /
        gathered.tables;
    out.push_back(
        std::sqrt(spread + shared_square(check, i) * here + mean_square(direct_error[i])));
  }
  return out;
}

}  // namespace lte::infer
