// What error to expect of the network's irradiance at a point, from what is cheap to know there.
#pragma once

#include <array>
#include <cstddef>

#include "lte/nn/config.h"

namespace lte::infer {

/// What an expected error is made of at a point, W/m², each a root mean square over the channels
/// (docs/metrics.md has what each foretells).
struct ErrorTerms {
  double draws = 0;   ///< standard error of the mean over the draws; 0 of a single one
  double mean = 0;    ///< the answer, averaged over all points
  double answer = 0;  ///< the answer here
  double near = 0;    ///< the answer times nearness_at(): what is near, scene points do not resolve
  double change = 0;  ///< how the answer changes within half the distance between latents
  double cache = 0;   ///< what the network adds to the light that it was told of, if it was
  double direct = 0;  ///< direct light here, where lamps are near or bright

  static constexpr std::array kNames = {"term_draws",  "term_mean",  "term_answer", "term_near",
                                        "term_change", "term_cache", "term_direct"};
  std::array<double, 7> values() const {
    return {draws, mean, answer, near, change, cache, direct};
  }
};

/// How much of each term counts. They were fitted by scripts/dev/fit_expected_error.py.
/// @param input    what the network is told of light
/// @param several  of several draws; of one, `draws` says nothing
const ErrorTerms& error_shares(nn::LightInput input, bool several);

/// The root of the sum of the squared terms, each times its share.
double expected_error(const ErrorTerms& terms, const ErrorTerms& shares);

}  // namespace lte::infer
