// Whether two primary hits see something else: what makes a pixel an edge (antialias.h).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "lte/pathtrace/gbuffer.h"

namespace lte::infer {

// Thresholds of an edge: what an eye sees as one surface stays one.
inline constexpr float kSameNormal = 0.97f;  ///< cosine, 14°
inline constexpr float kColorStep = 0.15f;  ///< of the root of albedo, about that of display values
inline constexpr float kEmissionStep = 0.1f;  ///< relative
inline constexpr float kMetalStep = 0.1f;

/// Whether both points lie in the planes of each other, within `tolerance` metres.
inline bool same_plane(const Vec3& a, const Vec3& normal_a, const Vec3& b, const Vec3& normal_b,
                       float tolerance) {
  const Vec3 between = b - a;
  return std::abs(dot(between, normal_a)) <= tolerance &&
         std::abs(dot(between, normal_b)) <= tolerance;
}

inline bool emissions_differ(const Rgb& a, const Rgb& b) {
  if (a == b) return false;
  for (int c = 0; c < 3; ++c) {
    if (std::abs(a[c] - b[c]) > kEmissionStep * std::max(a[c], b[c])) return true;
  }
  return false;
}

/// Whether two hits, each by its place in a buffer, see something else.
bool hits_differ(const pathtrace::GBuffer& of_a, size_t a, const pathtrace::GBuffer& of_b, size_t b,
                 float pixel_size);

/// Sets `bit` in bits[i] where hits a + i and b + i of a buffer differ, of `count`. hits_differ(),
/// many at once.
void mark_differing_hits(const pathtrace::GBuffer& hits, size_t a, size_t b, size_t count,
                         float pixel_size, uint8_t bit, uint8_t* bits);

/// The same for emissions_differ().
void mark_differing_emissions(const pathtrace::GBuffer& hits, size_t a, size_t b, size_t count,
                              uint8_t bit, uint8_t* bits);

}  // namespace lte::infer
