// Where rectangular ceiling lights may be (the paper's supplement, lighting heuristics): flush with
// the ceiling, at minimum distances from walls and from major occluders.
#pragma once

namespace lte::datagen {

inline constexpr float kLightWallDistance = 0.4f;  ///< metres between a light and any wall
inline constexpr float kLightTallDistance = 0.3f;  ///< metres sideways to a tall object
/// An object is tall if it reaches into this many metres below the ceiling.
inline constexpr float kLightHeadroom = 0.7f;

}  // namespace lte::datagen
