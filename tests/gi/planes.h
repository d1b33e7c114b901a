// Pictures of planes by closed form: what a pinhole camera at the origin that looks along −z sees.
#pragma once

#include <cmath>
#include <functional>
#include <vector>

#include "lte/gi/pixel_surfaces.h"

namespace lte::test {

/// A plane through `point`, seen where `covers` says so.
struct Plane {
  Vec3 point, normal;
  std::function<bool(const Vec3&)> covers = [](const Vec3&) { return true; };
};

struct PlanePicture {
  int width, height;
  float pixel_size;
  std::vector<Vec3> position, normal;
  std::vector<Rgb> albedo;
  std::vector<float> depth;
  std::vector<uint8_t> mask;
  std::vector<int> plane;  ///< the number of the plane, −1 for background

  PlanePicture(int w, int h, const std::vector<Plane>& planes)
      : width(w), height(h), pixel_size(2 * std::tan(kHalf) / static_cast<float>(h)) {
    for (int y = 0; y < h; ++y) {
      for (int x = 0; x < w; ++x) add(x, y, planes);
    }
  }

  gi::PixelSurfaces view() const {
    return {width, height, position, normal, depth, mask, pixel_size};
  }

  /// A function of position at every pixel.
  std::vector<Rgb> field(const std::function<Rgb(const Vec3&)>& value) const {
    std::vector<Rgb> out;
    for (const Vec3& p : position) out.push_back(value(p));
    return out;
  }

 private:
  static constexpr float kHalf = 0.5235988f;  // 30°

  void add(int x, int y, const std::vector<Plane>& planes) {
    const Vec3 ray{(static_cast<float>(x) + 0.5f - 0.5f * static_cast<float>(width)) * pixel_size,
                   (0.5f * static_cast<float>(height) - static_cast<float>(y) - 0.5f) * pixel_size,
                   -1};
    float nearest = INFINITY;
    int hit = -1;
    for (size_t i = 0; i < planes.size(); ++i) {
      const float t = dot(planes[i].point, planes[i].normal) / dot(ray, planes[i].normal);
      if (!(t > 0) || !(t < nearest) || !planes[i].covers(ray * t)) continue;
      nearest = t;
      hit = static_cast<int>(i);
    }
    Vec3 n;
    if (hit >= 0) {
      n = normalize(planes[static_cast<size_t>(hit)].normal);
      if (dot(n, ray) > 0) n = -n;
    }
    position.push_back(hit >= 0 ? ray * nearest : Vec3{});
    normal.push_back(n);
    albedo.push_back({0.5f, 0.5f, 0.5f});
    depth.push_back(nearest);
    mask.push_back(hit >= 0 ? 1 : 0);
    plane.push_back(hit);
  }
};

/// A wall that is turned away from the camera.
inline Plane tilted_wall() { return {{0, 0, -3}, {0.4f, 0.3f, 1}}; }

/// A floor and the wall at its end, which meet in a row of the picture's lower half.
inline std::vector<Plane> floor_and_wall() {
  return {{{0, -1, 0}, {0, 1, 0}}, {{0, 0, -4}, {0, 0, 1}}};
}

/// A wall with a plate before it, `gap` metres off, that covers the left half.
inline std::vector<Plane> wall_and_plate(float gap) {
  return {{{0, 0, -2}, {0, 0, 1}},
          {{0, 0, -2 + gap}, {0, 0, 1}, [](const Vec3& p) { return p.x < -0.013f; }}};
}

}  // namespace lte::test
