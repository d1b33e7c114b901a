// How much light that stays the same changes between the frames of a sequence: what an eye sees as
// flicker while the camera moves.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lte/image/image.h"
#include "lte/scene/scene.h"

namespace lte::infer {

/// A picture with what is needed to find its points again in the next one.
struct FlickerFrame {
  scene::Camera camera;
  image::Image light;  ///< 3 channels, linear: what is compared, best irradiance
  image::Image depth;  ///< 1 channel: distance along the camera's axis, 0 for background
};

/// Of a pair of frames, or of all pairs of a sequence.
struct Flicker {
  int64_t pixels = 0;    ///< of the first frames of the pairs
  int64_t compared = 0;  ///< of these: those whose point the next frame shows too
  double level = 0;      ///< mean of what is compared, over both frames, pixels and channels
  /// Root mean square of the change at compared points over `level`.
  double change = 0;
  /// With a reference: the same of its frames, over its own level, and the root mean square of the
  /// change less the reference's change at the same point, over the reference's level. The latter
  /// is 0 for pictures whose error stays where it is, whatever moves in the reference itself.
  double reference_change = 0, excess = 0;
};

/// Compares each frame with the next. The point that a pixel's centre shows is projected into the
/// next frame. It counts if the surface that the four pixels around its place there see lies at its
/// depth, within kDepthTolerance, and is one: none of the four is off by kDepthJump. Then nothing
/// hides it, and the value between the four is taken.
///
/// The measure finds noise that is drawn anew for each frame, and answers that jump with the point
/// of view. An interpolated value is smoother than a pixel, so texture of the size of pixels counts
/// as change: compare irradiance, which has none, or look at `excess`.
/// @param reference  as many frames by the same cameras, or none
/// @throws lte::Error for fewer than two frames, and sizes or cameras that differ.
Flicker measure_flicker(std::span<const FlickerFrame> frames,
                        std::span<const FlickerFrame> reference = {});

/// Of the depth of a point.
inline constexpr float kDepthTolerance = 0.01f, kDepthJump = 0.25f;

}  // namespace lte::infer
