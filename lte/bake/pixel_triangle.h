// A triangle in the pixels of an atlas.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "lte/base/math.h"
#include "lte/scene/scene.h"

namespace lte::bake {

class PixelTriangle {
 public:
  /// @param width, height  of the atlas, of which uvs[1] are shares
  PixelTriangle(const scene::Mesh& mesh, size_t triangle, int width, int height)
      : size_{width, height} {
    for (size_t k = 0; k < 3; ++k) {
      const Vec2& uv = mesh.uvs[1][mesh.triangles[triangle][k]];
      corners_[k] = {uv.x * static_cast<float>(width), uv.y * static_cast<float>(height)};
    }
    a_ = {corners_[1].x - corners_[0].x, corners_[1].y - corners_[0].y};
    b_ = {corners_[2].x - corners_[0].x, corners_[2].y - corners_[0].y};
    twice_area_ = a_.x * b_.y - a_.y * b_.x;
  }

  const std::array<Vec2, 3>& corners() const { return corners_; }
  /// Signed.
  float twice_area() const { return twice_area_; }

  /// Barycentric coordinates of the second and third corner at a place: (u, v) as
  /// scene::evaluate_surface() has them, drawn into the triangle from without.
  Vec2 barycentric(const Vec2& place) const {
    const float dx = place.x - corners_[0].x, dy = place.y - corners_[0].y;
    const float u = std::clamp((dx * b_.y - dy * b_.x) / twice_area_, 0.0f, 1.0f);
    const float v = std::clamp((a_.x * dy - a_.y * dx) / twice_area_, 0.0f, 1.0f);
    const float over = std::max(1.0f, u + v);
    return {u / over, v / over};
  }
  Vec2 at(const Vec2& uv) const {
    return {corners_[0].x + uv.x * a_.x + uv.y * b_.x, corners_[0].y + uv.x * a_.y + uv.y * b_.y};
  }

  /// Calls use(x, y) for the pixels of the picture within `margin` of the triangle's box.
  template <typename Use>
  void for_pixels(float margin, const Use& use) const {
    const auto range = [&](float Vec2::*axis, int size) {
      const auto [low, high] =
          std::minmax({corners_[0].*axis, corners_[1].*axis, corners_[2].*axis});
      return std::pair{std::clamp(static_cast<int>(std::floor(low - margin)), 0, size - 1),
                       std::clamp(static_cast<int>(std::floor(high + margin)), 0, size - 1)};
    };
    const auto [x0, x1] = range(&Vec2::x, size_[0]);
    const auto [y0, y1] = range(&Vec2::y, size_[1]);
    for (int y = y0; y <= y1; ++y)
      for (int x = x0; x <= x1; ++x) use(x, y);
  }

 private:
  std::array<int, 2> size_;
  std::array<Vec2, 3> corners_;
  Vec2 a_, b_;
  float twice_area_ = 0;
};

}  // namespace lte::bake
