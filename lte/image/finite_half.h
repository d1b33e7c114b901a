// Half floats of pictures: what is too bright for them is held to the brightest that they have.
#pragma once

#include <algorithm>

#include "lte/base/half.h"

namespace lte::image {

inline Half to_finite_half(float value) { return to_half(std::clamp(value, -kMaxHalf, kMaxHalf)); }

}  // namespace lte::image
