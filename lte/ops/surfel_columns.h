// The columns of discs that stand for a scene's points (surfels), and of what rays see of them.
#pragma once

#include <cstdint>

namespace lte::ops {

/// Columns of a disc.
struct SurfelColumn {
  enum Name : int64_t {
    kPosition = 0,
    kNormal = 3,
    kRadius = 6,
    kFront = 7,  ///< π times what the side of the normal sends out, over the emission scale
    kBack = 10,
    kEmission = 13,  ///< the same of what it emits
    kMetal = 16,     ///< reflectance of the metal at normal incidence, by channel
    kMetallic = 19,
    kRoughness = 20
  };
};
inline constexpr int64_t kSurfelColumns = 21;

/// Columns of what a ray sees: π radiance over the emission scale by channel, log(1 + it), whether
/// it meets a disc, the logarithm of the distance, the share of metal, and the cosine at the disc.
enum SeenColumn : int64_t {
  kSeenRadiance = 0,
  kSeenLog = 3,
  kSeenHit = 6,
  kSeenDistance = 7,
  kSeenMetal = 8,
  kSeenCosine = 9
};
inline constexpr int64_t kSeenColumns = 10;
/// Of these, what the network reads: all but the radiance itself.
inline constexpr int64_t kSeenFeatures = kSeenColumns - kSeenLog;

/// Rows of SurfelGrid::geometry.
inline constexpr int64_t kSurfelGeometry = 7;
/// In radii: nearer than this, a disc is the ray's own surface.
inline constexpr float kSurfelOwn = 0.1f;

}  // namespace lte::ops
