#include "infer/render/exposure.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <string>

#include "infer/render/frame_io.h"
#include "lte/base/check.h"

namespace lte::infer {
namespace {

/// Refuses what is no finite number of [low, high] in one short line.
CLI::Validator number_within(double low, double high, const std::string& range) {
  const auto check = [=](const std::string& text) -> std::string {
    const char *begin = text.data(), *end = begin + text.size();
    if (begin != end && *begin == '+') ++begin;  // from_chars takes no plus
    double value = 0;
    const auto read = std::from_chars(begin, end, value);
    const bool good = read.ec == std::errc() && read.ptr == end && value >= low && value <= high;
    return good ? "" : concat("expected a number ", range, ", got \"", text.substr(0, 40), "\"");
  };
  return CLI::Validator(check, "FLOAT");
}

}  // namespace

void add_exposure_options(CLI::App& app, ExposureOptions* options) {
  app.add_option("--exposure", options->exposure,
                 "Factor before the display curve of a PNG; by default from the picture's surfaces")
      ->check(number_within(1e-30, 1e30, "from 1e-30 to 1e30"));
  app.add_option("--ev", options->ev,
                 "Stops by which to brighten beside that: +1 doubles it, -1 halves it")
      ->check(number_within(-100, 100, "from -100 to 100"));
  app.add_option("--tone", options->tone,
                 "Of a PNG: how light beyond white is shown: clipped (linear), rolled off by "
                 "luminance (reinhard), or by a film's curve (filmic)")
      ->check(CLI::IsMember({"linear", "reinhard", "filmic"}))
      ->capture_default_str();
}

float choose_exposure(const Frame& frame, Output output, const ExposureOptions& options) {
  if (is_geometry(output)) return 1;
  const double base = options.exposure ? *options.exposure : double{frame_exposure(frame, output)};
  using Limits = std::numeric_limits<float>;
  return static_cast<float>(
      std::clamp(base * std::exp2(options.ev), double{Limits::min()}, double{Limits::max()}));
}

}  // namespace lte::infer
