#include "experiments/ticks.h"

#include <cmath>
#include <initializer_list>

namespace lte::experiments {
namespace {

constexpr double kWanted = 5;  // intervals of a linear axis
constexpr size_t kEnough = 3;  // ticks of a logarithmic one
constexpr double kMaxDecades = 8;
// A tick may lie outside the axis by as much as rounding moves it.
constexpr double kSlack = 1e-9;

/// 1, 2 or 5 times a power of ten, about a fifth of `span`.
double tick_step(double span) {
  const double power = std::pow(10.0, std::floor(std::log10(span / kWanted)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power * (1 + kSlack) >= span / kWanted) return factor * power;
  }
  return 10 * power;
}

/// `digits` times every `stride`-th power of ten inside [low, high].
std::vector<double> decade_ticks(double low, double high, std::initializer_list<double> digits,
                                 double stride) {
  std::vector<double> out;
  const double first = std::floor(std::log10(low) / stride) * stride;
  for (double decade = first; std::pow(10.0, decade) <= high * (1 + kSlack); decade += stride) {
    for (const double digit : digits) {
      const double value = digit * std::pow(10.0, decade);
      if (value >= low * (1 - kSlack) && value <= high * (1 + kSlack)) out.push_back(value);
    }
  }
  return out;
}

}  // namespace

std::vector<double> linear_ticks(double low, double high) {
  const double step = tick_step(high - low);
  const double first = std::ceil(low / step - kSlack);
  std::vector<double> out;
  // Counted, as adding 1 to a large `first` may change nothing.
  for (int i = 0; i <= 2 * kWanted && (first + i) * step <= high + kSlack * step; ++i)
    out.push_back((first + i) * step);
  return out;
}

std::vector<double> log_ticks(double low, double high) {
  const double stride = std::ceil(std::log10(high / low) / kMaxDecades);
  std::vector<double> out = decade_ticks(low, high, {1.0}, stride);
  if (out.size() < kEnough) out = decade_ticks(low, high, {1.0, 2.0, 5.0}, 1);
  return out.size() < kEnough ? linear_ticks(low, high) : out;
}

}  // namespace lte::experiments
