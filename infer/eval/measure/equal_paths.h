// A rival with the same number of paths, where it was measured with fewer and with more.
#pragma once

#include <map>
#include <optional>

#include "infer/eval/measure/scores.h"

namespace lte::infer {

/// The score of views with `paths` paths a pixel, on the straight line between the nearest numbers
/// of paths that were measured, in their logarithm; errors are logarithms too, PSNR and SSIM are
/// as they are. Nothing outside of what was measured.
/// @param measured  by paths a pixel, from 1 on
std::optional<ViewScore> score_between(const std::map<int, ViewScore>& measured, double paths);

}  // namespace lte::infer
