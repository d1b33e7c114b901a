// The rays of a camera, with what all of them share worked out once.
#pragma once

#include <cmath>

#include "lte/base/math.h"
#include "lte/scene/scene.h"

namespace lte::scene {

class CameraRays {
 public:
  explicit CameraRays(const Camera& camera)
      : forward_(normalize(camera.target - camera.origin)),
        right_(normalize(cross(forward_, camera.up))),
        above_(cross(right_, forward_)),
        half_(std::tan(camera.vfov * (kPi / 360.0f))),
        mirrored_(camera.mirrored) {}

  /// Camera::direction().
  Vec3 direction(float x, float y, float aspect) const {
    if (mirrored_) x = 1 - x;
    return normalize(forward_ + right_ * ((2 * x - 1) * half_ * aspect) +
                     above_ * ((1 - 2 * y) * half_));
  }

 private:
  Vec3 forward_, right_, above_;
  float half_;
  bool mirrored_;
};

}  // namespace lte::scene
