// What error to expect of gathered light at points (docs/lab/gather.md has how often it holds).
#pragma once

#include <span>
#include <vector>

#include "infer/check/light_check.h"
#include "infer/probe/gathered_probe.h"
#include "lte/base/math.h"

namespace lte::infer {

/// Root mean square over the channels, W/m², of the total at each point:
/// - what rays and tables disagree by at the point; known from so few tables, it is drawn a little
///   towards what they disagree by at all points, relative to the light there;
/// - what the light of the region may be off by, as paths find (CheckedRatio::expected_square);
/// - a share of the light, for errors within a region that all tables share: a constant one, and as
///   much as regions are off by (LightCheck::variance);
/// - the standard error of direct light.
///
/// So it is the same whatever has filled the tables: a network that is off shows in the paths.
/// @param direct_error  standard error of direct light by point
/// @param check         of `gathered.indirect`; without paths its parts are left out
std::vector<double> expected_errors(const GatheredProbe& gathered,
                                    std::span<const Rgb> direct_error, const LightCheck& check);

/// Found over wild rooms, so that two thirds of the points lie within what is expected and 95 %
/// within twice that.
inline constexpr double kUnseenShare = 0.02;

/// Root of the mean square over the channels.
double rms(const Rgb& value);

}  // namespace lte::infer
