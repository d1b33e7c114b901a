// Cameras that go around a scene, or look around in a room.
#pragma once

#include <vector>

#include "lte/pathtrace/bvh.h"
#include "lte/scene/scene.h"

namespace lte::pathtrace {

/// What a turntable does. All turn about the vertical (+Y).
enum class Turn {
  Around,     ///< a full turn around the middle of the scene, from outside
  LookRound,  ///< a full turn in place, from within a room
  Swing,      ///< to and fro before a box that is open on one side, such as Cornell's
};

struct Turntable {
  Turn turn = Turn::Around;
  std::vector<scene::Camera> cameras;
};

/// A turn of `count` even steps that begins with the camera `first` as it stands, and whose last
/// step leads to the first again, so that it can be shown in a loop.
///
/// - From a place that is enclosed, with a hit in most directions, the camera turns in place: to
///   circle it would have to go through furniture.
/// - Before a box that lacks one side (open_side_view()) it swings to either side by kSwingDegrees
///   about the middle of the scene: from behind there is nothing to see.
/// - Otherwise it circles the vertical through the place on its axis of view that is nearest to the
///   middle of the scene's bounds, which so stays in the middle of the picture.
/// Deterministic.
/// @param count  1 or more
Turntable turntable(const Bvh& bvh, const scene::Camera& first, int count);

inline constexpr float kSwingDegrees = 20;

}  // namespace lte::pathtrace
