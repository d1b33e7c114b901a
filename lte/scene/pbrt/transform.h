// Transforms of PBRT directives, in double: chains of them must not cost digits.
#pragma once

#include <array>

#include "lte/base/math.h"
#include "lte/scene/pbrt/source.h"

namespace lte::scene::pbrt {

/// p -> M p, row-major 4x4 whose last row may be anything until to_affine() checks it.
struct Transform {
  std::array<std::array<double, 4>, 4> m{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}};

  friend bool operator==(const Transform&, const Transform&) = default;
};

/// The product applies b first.
Transform operator*(const Transform& a, const Transform& b);

Transform translate(double x, double y, double z);
Transform scale(double x, double y, double z);
/// Turns by an angle about an axis, right-handed. An axis of length 0 gives the identity.
Transform rotate(double degrees, double x, double y, double z);
/// Takes the world to a camera at `eye` that has x to the right, y up and z ahead: a left-handed
/// frame, as pbrt's cameras have.
/// @throws lte::Error if eye and target coincide or up lies along the view.
Transform look_at(const std::array<double, 16>& eye_target_up, const Location& at);
/// Makes a transform of 16 numbers in column order, as Transform and ConcatTransform give them.
Transform from_columns(const std::array<double, 16>& columns);

/// @throws lte::Error naming `at` if the transform is singular.
Transform inverse(const Transform& t, const Location& at);

/// @throws lte::Error naming `at` if the transform has perspective, is singular, or lies beyond the
/// range of float.
Affine to_affine(const Transform& t, const Location& at);

}  // namespace lte::scene::pbrt
