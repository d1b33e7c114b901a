// What paths know better than the network, found while a picture rests and added to it.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "infer/picture/surface_guides.h"
#include "infer/renderer/light_check.h"
#include "infer/renderer/renderer.h"
#include "infer/session/session.h"
#include "infer/view/view_state.h"
#include "lte/image/image.h"

namespace lte::infer::view {

/// Of one state, camera and output with the network's indirect light.
class Residual {
 public:
  /// Paths a pixel of one step, and of all: the correction is found anew each time their number has
  /// doubled.
  static constexpr int kPaths = 4, kMostPaths = 64;
  static constexpr int kSteps = kMostPaths / kPaths;
  /// Gathered answers whose mean is corrected: one has noise of its own.
  static constexpr int kGathered = 4;

  void clear() { *this = {}; }
  /// Finds the answers at all pixels, unless they are there. What an exception of `settings.done`
  /// ends has not happened.
  /// @param settings  as of step()
  void answer(const SessionState& state, const scene::Camera& camera,
              const RenderSettings& settings);
  /// Of them one in each square of so many pixels that there are some thousands.
  AnsweredLight answered() const;
  bool done() const { return paths_ >= kMostPaths; }
  int paths() const { return paths_; }  ///< a pixel, by now

  /// Traces more paths. What an exception of `settings.done` ends has not happened.
  /// @param settings  of the picture: its output, size, and `done`
  /// @return  whether there is another correction
  bool step(const SessionState& state, const scene::Camera& camera, RenderSettings settings,
            StageSeconds* seconds);

  /// Adds the correction to a picture of that output; nothing before the first.
  void add_to(image::Image* picture) const;

 private:
  image::Image correction(const image::Image& half_a, const image::Image& half_b, Output output,
                          const std::function<void(int64_t)>& done) const;

  SurfaceGuides guides_;
  std::vector<uint8_t> reflects_;
  image::Image answer_, correction_;
  std::array<image::Image, 2> halves_;  ///< sums of irradiance by paths
  int paths_ = 0;
};

}  // namespace lte::infer::view
