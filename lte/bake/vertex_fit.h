// Internal: light at the corners of a scene's triangles, by least squares over a light map.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "lte/bake/lightmap.h"
#include "lte/bake/refined_scene.h"

namespace lte::bake {

/// Of the mean light: what is darker is compared with that.
inline constexpr double kDarkest = 0.1;
/// Samples along a triangle at most.
inline constexpr int kMostSamples = 128;

/// What a layer of a light map, or the sum of several, shows at a place, as engines look it up.
class Picture {
 public:
  /// @param light  [height, width, 3] W/m², borrowed
  Picture(const Lightmap& map, std::span<const float> light)
      : width_(map.width), height_(map.height), light_(light) {
    double sum = 0, lit = 0;
    for (size_t i = 0; i < map.pixels(); ++i) {
      if (map.mask[i] != static_cast<uint8_t>(Texel::Lit)) continue;
      sum += double{luminance(pixel(i))};
      ++lit;
    }
    darkest_ = lit > 0 && sum > 0 ? kDarkest * sum / lit : 1;
  }

  Vec2 in_pixels(const Vec2& uv) const {
    return {uv.x * static_cast<float>(width_), uv.y * static_cast<float>(height_)};
  }
  Rgb at(const Vec2& place) const {
    const float x = place.x - 0.5f, y = place.y - 0.5f;
    const float fx = x - std::floor(x), fy = y - std::floor(y);
    const int px = static_cast<int>(std::floor(x)), py = static_cast<int>(std::floor(y));
    return (pixel(px, py) * (1 - fx) + pixel(px + 1, py) * fx) * (1 - fy) +
           (pixel(px, py + 1) * (1 - fx) + pixel(px + 1, py + 1) * fx) * fy;
  }
  /// W/m², luminance; darker places count as this.
  double darkest() const { return darkest_; }

 private:
  Rgb pixel(size_t i) const { return {light_[3 * i], light_[3 * i + 1], light_[3 * i + 2]}; }
  Rgb pixel(int x, int y) const {
    return pixel(static_cast<size_t>(std::clamp(y, 0, height_ - 1)) * static_cast<size_t>(width_) +
                 static_cast<size_t>(std::clamp(x, 0, width_ - 1)));
  }

  int width_, height_;
  std::span<const float> light_;
  double darkest_ = 1;
};

/// Even samples of a leaf: the middles of n² equal parts.
struct LeafSamples {
  std::array<Vec2, 3> corner;  ///< in pixels
  int along = 1;
  double area = 0;  ///< texels

  LeafSamples(const Picture& picture, const scene::Mesh& mesh, const Leaf& leaf) {
    for (size_t k = 0; k < 3; ++k) corner[k] = picture.in_pixels(mesh.uvs[1][leaf.vertex[k]]);
    const Vec2 &a = corner[0], &b = corner[1], &c = corner[2];
    area = 0.5 *
           std::abs(double{b.x - a.x} * double{c.y - a.y} - double{b.y - a.y} * double{c.x - a.x});
    along = std::clamp(static_cast<int>(std::ceil(std::sqrt(2 * area))), 1, kMostSamples);
  }
  float longest_edge() const {
    float out = 0;
    for (size_t k = 0; k < 3; ++k) {
      const Vec2 &a = corner[k], &b = corner[(k + 1) % 3];
      out = std::max(out, std::hypot(b.x - a.x, b.y - a.y));
    }
    return out;
  }
  double weight() const { return area / (static_cast<double>(along) * along); }

  /// Calls use(λ, light).
  template <typename Use>
  void for_each(const Picture& picture, const Use& use) const {
    const auto n = static_cast<float>(along);
    const auto sample = [&](float u, float v) {
      const std::array<float, 3> share{1 - (u + v) / n, u / n, v / n};
      Vec2 place;
      for (size_t k = 0; k < 3; ++k) {
        place.x += share[k] * corner[k].x;
        place.y += share[k] * corner[k].y;
      }
      use(share, picture.at(place));
    };
    for (int i = 0; i < along; ++i) {
      for (int j = 0; i + j < along; ++j) {
        const auto u = static_cast<float>(i), v = static_cast<float>(j);
        sample(u + 1.0f / 3, v + 1.0f / 3);
        if (i + j + 1 < along) sample(u + 2.0f / 3, v + 2.0f / 3);
      }
    }
  }
};

/// The unknowns: corners of leaves that share a place and a smooth surface have one.
struct Knots {
  std::vector<std::array<uint32_t, 3>> of_leaf;
  uint32_t count = 0;
};

Knots find_knots(const std::vector<Leaf>& leaves);

/// Light at knots.
struct Fit {
  std::vector<Rgb> light;    ///< [knots] W/m²
  std::vector<double> mean;  ///< [leaves] luminance
};

Fit fit(const Picture& picture, const RefinedScene& refined, const Knots& knots);

/// Luminance at a place of a leaf whose corners are those knots.
float interpolated(const Fit& fit, const std::array<uint32_t, 3>& knot,
                   const std::array<float, 3>& share);

}  // namespace lte::bake
