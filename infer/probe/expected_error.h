// What error to expect of gathered light at points (docs/metrics.md has how often it holds).
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
/// - what paths say that the light of the region is off by, beyond what chance explains;
/// - a share of the light, for errors within a region that all tables share;
/// - the standard error of direct light.
/// @param direct_error  standard error of direct light by point
/// @param check         of `gathered.indirect`; without paths its part is left out
/// @param unseen_share  kUnseenShare or kUnseenShareOfNetwork
std::vector<double> expected_errors(const GatheredProbe& gathered,
                                    std::span<const Rgb> direct_error, const LightCheck& check,
                                    double unseen_share);

/// Found over ten rooms, of which none is a test scene, so that two thirds of the points lie within
/// what is expected and 95 % within twice that: where tables are path-traced, and where the network
/// has filled them.
inline constexpr double kUnseenShare = 0.015, kUnseenShareOfNetwork = 0.1;

/// Root of the mean square over the channels.
double rms(const Rgb& value);

}  // namespace lte::infer
