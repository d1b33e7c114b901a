// The range of numbers that a scene may have. It is far within float's, so that what the path
// tracer makes of them stays finite: squares of distances, radiance times area, inverses of
// transforms.
#pragma once

#include <string>

#include "lte/base/math.h"
#include "lte/scene/scene.h"

namespace lte::scene {

/// The farthest that anything may be from the origin along each axis, metres. Embree traces rays
/// whose coordinates are below 1.844e18 in the world and in the frame of every instance, and ends
/// the process otherwise; kMinScale is what lies between the two.
inline constexpr float kMaxCoordinate = 1e9f;
/// Instances may be scaled by factors from 1e-8 to 1e12.
inline constexpr double kMinScale = 1e-8, kMaxScale = 1e12;
/// An instance of smaller extent may be scaled by less, as programs hide things; it is not traced.
inline constexpr float kHiddenExtent = 1e-6f;
/// The most that a radiance, a radiant intensity or an irradiance may be, in its unit. The sun's
/// radiance is 2e7.
inline constexpr float kMaxRadiance = 1e12f;

/// Whether `p` is within kMaxCoordinate. Not if it is not finite.
inline bool is_place(const Vec3& p) {
  return std::abs(p.x) <= kMaxCoordinate && std::abs(p.y) <= kMaxCoordinate &&
         std::abs(p.z) <= kMaxCoordinate;
}

/// Whether every component is within kMaxRadiance. Not if one is not finite.
inline bool is_radiance(const Rgb& c) {
  return std::abs(c.x) <= kMaxRadiance && std::abs(c.y) <= kMaxRadiance &&
         std::abs(c.z) <= kMaxRadiance;
}

/// The largest factor by which the inverse of a transform stretches an axis (largest absolute row
/// sum); infinity for a singular one, whose instance is not traced.
double inverse_stretch(const Affine& transform);

/// Checks every number of a scene that rays, lights or cameras depend on.
/// @param file  for the message
/// @throws lte::Error naming file and element (mesh and vertex, light, camera, material) that is
///         outside these ranges. A vertex that no triangle uses may be anywhere.
void check_numbers(const std::string& file, const Scene& scene);

/// The same of an environment alone. @param what  for the message
void check_environment(const std::string& what, const Environment& environment);

}  // namespace lte::scene
