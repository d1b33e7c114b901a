// Pictures beside and under one another on white, for reports.
#pragma once

#include <vector>

#include "lte/image/image.h"

namespace lte::infer {

/// In a row, with gaps, each pixel drawn as a square of `zoom` pixels. Pictures are of one height.
image::Image side_by_side(const std::vector<image::Image>& pictures, int zoom);

/// One under the other, with gaps.
image::Image stacked(const std::vector<image::Image>& rows);

}  // namespace lte::infer
