// A picture in which luminaires are dimmed and recoloured without rendering: light is linear in
// each, and so is a picture before its exposure.
#pragma once

#include <vector>

#include "infer/picture/frame.h"
#include "infer/renderer/renderer.h"
#include "infer/session/session.h"

namespace lte::infer {

/// For a slider that is dragged while the camera rests. Immutable once it is made; thread-safe.
class DimmablePicture {
 public:
  /// Renders a picture for each layer of the state: the touched luminaires one by one, and the
  /// others together.
  /// @param settings  of an output that is light
  /// @throws lte::Error for one that is not
  DimmablePicture(const StatePtr& state, const scene::Camera& camera, RenderSettings settings);

  /// Whether the picture of `state` follows from these: it differs by gains and colours of touched
  /// luminaires alone.
  bool fits(const SessionState& state) const;

  /// The picture of `state`, which it fits(): color and depth. Its direct light is sampled layer by
  /// layer, so its noise is not that of SessionState::render().
  Frame picture(const SessionState& state) const;

 private:
  StatePtr made_for_;
  std::vector<Frame> layers_;
};

}  // namespace lte::infer
