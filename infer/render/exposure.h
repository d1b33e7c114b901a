// How a PNG shows light: the keys exposure, ev and tone.
#pragma once

#include <optional>
#include <string>

#include "infer/renderer/render_settings.h"
#include "lte/cli/set_keys.h"

namespace lte::infer {

struct ExposureOptions {
  std::optional<double> exposure = {};  ///< nothing: by the picture
  bool first = false;                   ///< all pictures of a run take that of the first one
  double ev = 0;                        ///< stops: factors of two beside it
  std::string tone = "linear";          ///< a word of image::ToneCurve
};

/// Adds the keys.
void add_exposure_keys(SetKeys* keys, ExposureOptions* options);

/// The factor of the picture: the exposure that was given, else frame_exposure(), times 2^ev; 1 for
/// an output that is no light.
float choose_exposure(const Frame& frame, Output output, const ExposureOptions& options);

}  // namespace lte::infer
