// What error to expect of gathered light at points (docs/points.md has how often it holds).
#pragma once

#include <span>
#include <vector>

#include "infer/check/light_check.h"
#include "infer/probe/gathered_probe.h"
#include "lte/base/math.h"
#include "lte/gi/expected_error.h"

namespace lte::infer {

/// Root mean square over the channels, W/m², of the total at each point (lte/gi/expected_error.h):
/// - what rays and tables disagree by at the point; known from so few tables, it is drawn towards
///   what they disagree by at all points, relative to the light there;
/// - what all of them share, as far as paths know the region's (CheckedRatio::expected_square);
/// - the standard error of direct light.
///
/// So it is the same whatever has filled the tables: a network that is off shows in the paths.
/// @param direct_error  standard error of direct light by point
/// @param check         of `gathered.indirect`; without paths nothing is known of what is shared
std::vector<double> expected_errors(const GatheredProbe& gathered,
                                    std::span<const Rgb> direct_error, const LightCheck& check);

/// Root of the mean square over the channels.
double rms(const Rgb& value);

/// Of the light at all points.
gi::ErrorUnit error_unit(std::span<const Rgb> light);

}  // namespace lte::infer
