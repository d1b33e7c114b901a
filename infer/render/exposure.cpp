#include "infer/render/exposure.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "infer/render/frame_io.h"
#include "lte/base/check.h"
#include "lte/base/to_number.h"

namespace lte::infer {
namespace {

constexpr double kMinExposure = 1e-30, kMaxExposure = 1e30, kMaxStops = 100;

/// "auto", "first" or a factor.
std::string read_exposure(const std::string& text, ExposureOptions* options) {
  options->first = text == "first";
  options->exposure.reset();
  if (text == "auto" || options->first) return "";
  const auto value = to_number<double>(text);
  if (!value || !(*value >= kMinExposure && *value <= kMaxExposure))
    return "expected auto, first or a factor from 1e-30 to 1e30";
  options->exposure = *value;
  return "";
}

}  // namespace

void add_exposure_keys(SetKeys* keys, ExposureOptions* options) {
  keys->add(
      "exposure", "auto|first|F",
      [options](const std::string& text) { return read_exposure(text, options); },
      [options] {
        if (options->exposure) return concat(*options->exposure);
        return std::string(options->first ? "first" : "auto");
      },
      "factor before the display curve of a PNG; auto: by each picture's surfaces; first: "
      "all pictures take the first one's, as with --turntable and --edit");
  keys->add("ev", &options->ev, -kMaxStops, kMaxStops,
            "stops by which to brighten beside that: +1 doubles it, -1 halves it");
  keys->add("tone", &options->tone, {"linear", "reinhard", "filmic"},
            "of a PNG, light beyond white: clipped (linear), rolled off by luminance (reinhard), "
            "or by a film's curve (filmic)");
}

float choose_exposure(const Frame& frame, Output output, const ExposureOptions& options) {
  if (render::is_geometry(output)) return 1;
  const double base = options.exposure ? *options.exposure : double{frame_exposure(frame, output)};
  using Limits = std::numeric_limits<float>;
  return static_cast<float>(
      std::clamp(base * std::exp2(options.ev), double{Limits::min()}, double{Limits::max()}));
}

}  // namespace lte::infer
