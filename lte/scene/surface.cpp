// Appearance at a point of a triangle.
#include "lte/scene/surface.h"

#include "lte/scene/texel_densities.h"
#include "lte/scene/triangle.h"

namespace lte::scene {
namespace {

struct Barycentric {
  float w, u, v;

  template <typename T>
  T mix(const T& a, const T& b, const T& c) const {
    return a * w + b * u + c * v;
  }
};

Vec2 interpolate(const Barycentric& b, const Vec2& a0, const Vec2& a1, const Vec2& a2) {
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

Rgb saturate(const Rgb& c) { return min(max(c, {0, 0, 0}), {1, 1, 1}); }

}  // namespace

void evaluate_appearance(const Scene& scene, int instance, uint32_t triangle, float u, float v,
                         float footprint, Rgb* albedo, Rgb* emission) {
  evaluate_appearance(scene, instance, triangle, u, v, footprint, nullptr, albedo, emission);
}

void evaluate_appearance(const Scene& scene, int instance, uint32_t triangle, float u, float v,
                         float footprint, TexelDensities* known, Rgb* albedo, Rgb* emission) {
  const Mesh& mesh = scene.meshes[scene.instances[instance].mesh];
  const Material& material = scene.materials[mesh.material];
  const TextureLookup lookup(scene, instance, triangle, footprint, known);
  const Barycentric b{1 - u - v, u, v};
  Rgb color = material.base_color * lookup(material.base_color_texture, b);
  if (!mesh.colors.empty()) {
    const std::array<uint32_t, 3>& corner = mesh.triangles[triangle];
    color *= b.mix(mesh.colors[corner[0]], mesh.colors[corner[1]], mesh.colors[corner[2]]);
  }
  *albedo = saturate(color);
  *emission =
      material.emissive() ? material.emission * lookup(material.emission_texture, b) : Rgb{};
}

Gloss evaluate_gloss(const Scene& scene, int instance, uint32_t triangle, float u, float v,
                     float footprint) {
  const Instance& placed = scene.instances[instance];
  const Material& material = scene.materials[scene.meshes[placed.mesh].material];
  if (material.metallic_roughness_texture.texture == kNone)
    return {material.metallic, material.roughness};
  const TextureLookup lookup(scene, instance, triangle, footprint);
  const Rgb texel = lookup(material.metallic_roughness_texture, {1 - u - v, u, v});
  return {material.metallic * texel.z, material.roughness * texel.y};
}

Surface evaluate_surface(const Scene& scene, int instance, uint32_t triangle, float u, float v,
                         float footprint) {
  const Instance& placed = scene.instances[instance];
  const Mesh& mesh = scene.meshes[placed.mesh];
  const WorldTriangle corners = world_triangle(mesh, placed.to_world, triangle);
  const Barycentric b{1 - u - v, u, v};

  Surface surface;
  surface.position = b.mix(corners.p0, corners.p1, corners.p2);
  const AreaVector cross = area_vector(corners);
  const double norm = cross.norm();
  if (norm > 0) {
    const double sign = placed.to_world.determinant() < 0 ? -1 : 1;
    surface.normal = {static_cast<float>(sign * cross.x / norm),
                      static_cast<float>(sign * cross.y / norm),
                      static_cast<float>(sign * cross.z / norm)};
  }
  evaluate_appearance(scene, instance, triangle, u, v, footprint, &surface.albedo,
                      &surface.emission);
  surface.gloss = evaluate_gloss(scene, instance, triangle, u, v, footprint);
  const Material& material = scene.materials[mesh.material];
  surface.light_group = material.emissive() ? placed.light_group : kNone;
  surface.emits_back = material.emissive() && material.double_sided;
  return surface;
}

}  // namespace lte::scene
