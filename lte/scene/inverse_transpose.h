// The inverse transpose of a transform: it turns normals, and tells how a transform shrinks.
#pragma once

#include <array>
#include <optional>

#include "lte/base/math.h"

namespace lte::scene {

using Matrix3 = std::array<std::array<double, 3>, 3>;

/// Of the transform without its translation; nothing if that is singular or not finite. In double:
/// a determinant is a product of three scales and leaves the float range long before a scale does.
std::optional<Matrix3> inverse_transpose(const Affine& transform);

}  // namespace lte::scene
