// A picture as a sum by luminaire, in which they are dimmed and recolored without rendering: light
// is linear in each, and so is a picture before its exposure. It gets better picture by picture;
// what has been rendered stays good whatever the gains.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "infer/renderer/renderer.h"
#include "infer/session/session.h"
#include "infer/session/state.h"

namespace lte::infer {

/// The mean of pictures of one camera. Copies share nothing that changes.
class DimmablePicture {
 public:
  /// Sums of more bytes than this, scenes by luminaire included, are not kept apart.
  static constexpr int64_t kMaxBytes = int64_t{256} << 20;

  /// Begins without a picture. A layer is a touched luminaire or all the others together.
  ///
  /// There is one layer of all light, which no other gains fit, where the output has no light, the
  /// state's is not Accuracy::Full, or the layers would take too much memory.
  /// @param pixels  of the pictures to come
  DimmablePicture(StatePtr state, Output output, int64_t pixels);

  /// Whether it can be the picture of `state`: that differs from the one it was made for by gains
  /// and colors of touched luminaires alone.
  bool fits(const SessionState& state) const;
  int layers() const { return static_cast<int>(layers_.size()); }

  /// Renders a picture a layer and adds it to the sums; rays and paths are shared out among
  /// the layers.
  ///
  /// What `settings.stop` ends has not happened, but the layers that were done by
  /// then are kept: the next add() must be for the same picture, and goes on with the others.
  /// @param settings  of the output and the number of pixels given before
  /// @param anew      drop the pictures before
  /// @param seconds   set to the times of all layers' stages
  void add(const scene::Camera& camera, RenderSettings settings, bool anew, StageSeconds* seconds);

  /// Takes the noise out of the mean, layer by layer, until the next add(). Nothing happens where
  /// there is no Open Image Denoise, or no light in the output.
  void denoise(image::OidnQuality quality);

  int pictures() const { return pictures_; }  ///< in the mean
  void clear();

  /// The mean as it is with the gains of `state`, which it fits(). Direct light is sampled layer by
  /// layer, so its noise is not that of SessionState::render().
  image::Image color(const SessionState& state) const;
  /// Of the last picture.
  const image::Image& depth() const { return depth_; }

 private:
  struct Layer {
    std::shared_ptr<const SessionState::Parts> alone;  ///< at gain 1
    int group = 0;                                     ///< whose gain it has
    image::Image sum;
    image::Image clean = {};  ///< the mean without noise; empty before denoise()
  };
  StatePtr made_for_;
  Output output_;
  bool apart_ = false;
  std::vector<Layer> layers_;
  image::Image depth_;
  image::Image albedo_, normal_;  ///< sums
  int pictures_ = 0;
  /// Of a picture that was ended: the first layers' frames.
  std::vector<Frame> unfinished_;
  StageSeconds unfinished_seconds_;
};

}  // namespace lte::infer
