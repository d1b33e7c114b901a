// The automatic view of a scene that has no camera, or of one whose cameras are not wanted.
#pragma once

#include <cstdint>
#include <optional>

#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/placement/free_space.h"
#include "lte/scene/scene.h"

namespace lte::pathtrace {

/// The first of these that there is; docs/cameras.md has it in words:
/// - open_side_view(): a box that lacks one side, such as Cornell's, from outside;
/// - inside_view(): from eye height in a room, and never in the open where there are rooms;
/// - outside_view(): anything else, which then fills the frame.
/// Deterministic.
/// @param seed    chooses among views from inside
/// @param aspect  width over height of the picture, for views from outside
scene::Camera auto_camera(const Bvh& bvh, uint64_t seed = 0, float aspect = 1);

/// From outside through the one side that is open, at the distance where that side fills the
/// frame. Nothing if none or another one is open (the ceiling may be), or if the side is over twice
/// as wide as high, or the other way round: such a stage is better seen from within.
std::optional<scene::Camera> open_side_view(const Bvh& bvh, const FreeSpace& space, float aspect);

/// From inside the largest free space at eye height, 1.2 to 1.7 m above the floor. Candidates are
/// scored by the spread of hit distances, by the share of pixels that meet a front face, by how
/// many things are in view, by a lamp in sight and by staying clear of surfaces. Places under a
/// ceiling come before all others; others will do if walls surround the scene. In rooms of less
/// than 2.5 or more than 60 units, such as those in centimetres, lengths are taken in proportion.
/// Nothing if no place is enclosed.
std::optional<scene::Camera> inside_view(const Bvh& bvh, const FreeSpace& space, uint64_t seed);

/// From outside and above, with the subject filling kOutsideFill of the frame's width or height.
/// Lamps and large flat things, such as ground and backdrop, are no part of the subject where
/// anything else is much smaller than they are. Of several directions the one that shows most of
/// its front faces is taken, front right if none is much better.
scene::Camera outside_view(const Bvh& bvh, float aspect);

/// Of a side, so that a square subject covers about two thirds of the frame.
inline constexpr float kOutsideFill = 0.8f;

}  // namespace lte::pathtrace
