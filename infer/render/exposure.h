// How a PNG shows light: --exposure, --ev and --tone.
#pragma once

#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "infer/renderer/renderer.h"

namespace lte::infer {

struct ExposureOptions {
  std::optional<double> exposure;  ///< nothing: by the picture
  double ev = 0;                   ///< stops: factors of two beside it
  std::string tone = "linear";     ///< a word of image::ToneCurve
};

/// Adds --exposure and --ev, which take finite numbers alone, and --tone.
void add_exposure_options(CLI::App& app, ExposureOptions* options);

/// The factor of the picture: the exposure that was given, else frame_exposure(), times 2^ev; 1 for
/// an output that is no light.
float choose_exposure(const Frame& frame, Output output, const ExposureOptions& options);

}  // namespace lte::infer
