// Between points of a scene and places in a picture of it.
#pragma once

#include <optional>

#include "lte/base/math.h"
#include "lte/scene/scene.h"

namespace lte::infer {

/// Places in a picture by its camera: (0, 0) is the top left corner, (width, height) the opposite.
class Projection {
 public:
  Projection(const scene::Camera& camera, int width, int height)
      : origin_(camera.origin),
        view_(normalize(camera.target - camera.origin)),
        width_(static_cast<float>(width)),
        height_(static_cast<float>(height)) {
    const float aspect = width_ / height_;
    right_ = at_depth_1(camera.direction(1, 0.5f, aspect)) - view_;
    down_ = at_depth_1(camera.direction(0.5f, 1, aspect)) - view_;
    pixels_right_ = right_ * (width_ / 2 / dot(right_, right_));
    pixels_down_ = down_ * (height_ / 2 / dot(down_, down_));
  }

  /// The point at this depth that a place of the picture shows.
  Vec3 point(float x, float y, float depth) const {
    return origin_ +
           (view_ + right_ * (2 * x / width_ - 1) + down_ * (2 * y / height_ - 1)) * depth;
  }

  struct Place {
    float x, y, depth;
  };
  /// Where a point is seen; nothing if it lies behind the camera.
  std::optional<Place> place(const Vec3& point) const {
    const Vec3 v = point - origin_;
    const float depth = dot(v, view_);
    if (!(depth > 0)) return std::nullopt;
    const Vec3 at = v / depth - view_;
    return Place{dot(at, pixels_right_) + width_ / 2, dot(at, pixels_down_) + height_ / 2, depth};
  }

 private:
  Vec3 at_depth_1(const Vec3& direction) const { return direction / dot(direction, view_); }

  Vec3 origin_, view_, right_, down_;
  Vec3 pixels_right_, pixels_down_;  ///< pixels a length along each of both, at depth 1
  float width_, height_;
};

}  // namespace lte::infer
