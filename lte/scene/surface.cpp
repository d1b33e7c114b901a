// Appearance at a point of a triangle.
#include "lte/scene/surface.h"

#include "lte/scene/texel_densities.h"
#include "lte/scene/texture_lookup.h"
#include "lte/scene/triangle.h"

namespace lte::scene {
namespace {

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
