// Internal: textures of a triangle's material at a point of it.
#pragma once

#include <cmath>
#include <vector>

#include "lte/scene/scene.h"
#include "lte/scene/texel_densities.h"
#include "lte/scene/triangle.h"

namespace lte::scene {

struct Barycentric {
  float w, u, v;

  template <typename T>
  T mix(const T& a, const T& b, const T& c) const {
    return a * w + b * u + c * v;
  }
};

inline Vec2 interpolate(const Barycentric& b, const Vec2& a0, const Vec2& a1, const Vec2& a2) {
  return {a0.x * b.w + a1.x * b.u + a2.x * b.v, a0.y * b.w + a1.y * b.u + a2.y * b.v};
}

/// One texture lookup on one triangle.
class TextureLookup {
 public:
  /// @param known  may be null
  TextureLookup(const Scene& scene, int instance, uint32_t triangle, float footprint,
                TexelDensities* known = nullptr)
      : scene_(scene),
        number_(instance),
        instance_(scene.instances[instance]),
        mesh_(scene.meshes[instance_.mesh]),
        triangle_(triangle),
        footprint_(footprint),
        known_(known) {}

  /// White where there is no texture or the mesh lacks its UV set: the factor alone stays.
  Rgb operator()(const TextureRef& ref, const Barycentric& b) const {
    if (ref.texture == kNone) return {1, 1, 1};
    const std::vector<Vec2>& uvs = mesh_.uvs[ref.uv_set];
    if (uvs.empty()) return {1, 1, 1};
    const std::array<uint32_t, 3>& corner = mesh_.triangles[triangle_];
    const Vec2 a = uvs[corner[0]], c = uvs[corner[1]], d = uvs[corner[2]];
    const Texture& texture = *scene_.textures[ref.texture];
    const Vec2 uv = ref.transform(interpolate(b, a, c, d));
    const float edge = footprint_ > 0 ? texels(texture, ref, a, c, d) : 0;
    return texture.sample(uv, ref.wrap_u, ref.wrap_v, edge);
  }

 private:
  /// Edge in texels of the square that covers footprint² world metres.
  float texels(const Texture& texture, const TextureRef& ref, const Vec2& uv0, const Vec2& uv1,
               const Vec2& uv2) const {
    const auto work_out = [&] { return density(texture, ref, uv0, uv1, uv2); };
    const double a_metre =
        known_ != nullptr ? known_->of(ref, number_, triangle_, work_out) : work_out();
    return static_cast<float>(a_metre * footprint_);
  }

  /// Edges of texels a world metre, by the ratio of the triangle's areas.
  double density(const Texture& texture, const TextureRef& ref, const Vec2& uv0, const Vec2& uv1,
                 const Vec2& uv2) const {
    const Vec2 a = ref.transform(uv0), b = ref.transform(uv1), c = ref.transform(uv2);
    const double world = area(world_triangle(mesh_, instance_.to_world, triangle_));
    if (!(world > 0)) return 0;
    const double uv = 0.5 * std::abs((double{b.x} - a.x) * (double{c.y} - a.y) -
                                     (double{c.x} - a.x) * (double{b.y} - a.y));
    return std::sqrt(uv * texture.width() * texture.height() / world);
  }

  const Scene& scene_;
  int number_;
  const Instance& instance_;
  const Mesh& mesh_;
  uint32_t triangle_;
  float footprint_;
  TexelDensities* known_;
};

}  // namespace lte::scene
