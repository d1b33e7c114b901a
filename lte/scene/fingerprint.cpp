#include "lte/scene/fingerprint.h"

#include <cstdint>
#include <type_traits>
#include <vector>

#include "lte/base/checksum.h"
#include "lte/base/text.h"

namespace lte::scene {
namespace {

/// Adds values one by one: a struct's padding is nobody's.
template <typename T>
void add(Checksum* sum, const T& value) {
  static_assert(std::is_arithmetic_v<T> || std::is_enum_v<T>);
  sum->add(&value, sizeof value);
}

void add(Checksum* sum, const Vec2& v) { sum->add(&v, sizeof v); }
void add(Checksum* sum, const Vec3& v) { sum->add(&v, sizeof v); }

/// With its length, so that what follows cannot be taken for a part of it.
template <typename T>
void add_all(Checksum* sum, const std::vector<T>& values) {
  add(sum, uint64_t{values.size()});
  sum->add(values.data(), sizeof(T) * values.size());
}

void add(Checksum* sum, const TextureRef& ref) {
  add(sum, ref.texture);
  if (ref.texture == kNone) return;
  add(sum, ref.uv_set);
  add(sum, ref.wrap_u);
  add(sum, ref.wrap_v);
  add(sum, ref.offset);
  add(sum, ref.scale);
  add(sum, ref.rotation);
}

bool has_normal_map(const Scene& scene, const Mesh& mesh) {
  const auto material = static_cast<size_t>(mesh.material);
  return material < scene.materials.size() &&
         scene.materials[material].normal_texture.texture != kNone;
}

void add_shape(Checksum* sum, const Mesh& mesh) {
  add_all(sum, mesh.positions);
  add_all(sum, mesh.triangles);
  for (const std::vector<Vec2>& uvs : mesh.uvs) add_all(sum, uvs);
  add_all(sum, mesh.colors);
}

void add_shading(Checksum* sum, const Mesh& mesh) {
  add_all(sum, mesh.normals);
  for (const auto& tangent : mesh.tangents) {
    add(sum, tangent.direction);
    add(sum, tangent.sign);
  }
}

std::string digits(const Checksum& sum) {
  return formatted("%016llx", static_cast<unsigned long long>(sum.value()));
}

std::string geometry_of(const Scene& scene) {
  Checksum sum;
  for (const Mesh& mesh : scene.meshes) {
    add_shape(&sum, mesh);
    // Without a normal map nothing is shaded by them.
    if (has_normal_map(scene, mesh)) add_shading(&sum, mesh);
    add(&sum, mesh.material);
  }
  for (const Instance& instance : scene.instances) {
    add(&sum, instance.mesh);
    sum.add(&instance.to_world.m, sizeof instance.to_world.m);
  }
  return digits(sum);
}

std::string materials_of(const Scene& scene) {
  Checksum sum;
  for (const Material& material : scene.materials) {
    add(&sum, material.base_color);
    add(&sum, material.base_color_texture);
    add(&sum, material.emission);
    add(&sum, material.emission_texture);
    add(&sum, material.double_sided);
    add(&sum, material.metallic);
    add(&sum, material.roughness);
    add(&sum, material.metallic_roughness_texture);
    if (material.normal_texture.texture == kNone) continue;
    add(&sum, material.normal_texture);
    add(&sum, material.normal_scale);
  }
  for (const auto& texture : scene.textures) {
    add(&sum, texture != nullptr);
    if (texture == nullptr) continue;
    add(&sum, texture->width());
    add(&sum, texture->height());
    add(&sum, texture->srgb());
    add_all(&sum, texture->texels());
  }
  return digits(sum);
}

void add(Checksum* sum, const Environment& environment) {
  add(sum, environment.radiance);
  for (const Vec3& axis : environment.axes) add(sum, axis);
  add(sum, environment.light_group);
  if (environment.map == nullptr) return;
  const EnvironmentMap& map = *environment.map;
  add(sum, map.width());
  add(sum, map.height());
  add(sum, map.mapping());
  const auto texels = static_cast<size_t>(map.width()) * static_cast<size_t>(map.height());
  for (size_t i = 0; i < texels; ++i) add(sum, map.texel(i));
}

std::string lights_of(const Scene& scene) {
  Checksum sum;
  for (const Instance& instance : scene.instances) add(&sum, instance.light_group);
  for (const PunctualLight& light : scene.lights) {
    add(&sum, light.kind);
    add(&sum, light.position);
    add(&sum, light.direction);
    add(&sum, light.intensity);
    add(&sum, light.range);
    add(&sum, light.inner_cone);
    add(&sum, light.outer_cone);
    add(&sum, light.light_group);
  }
  add(&sum, scene.environment.has_value());
  if (scene.environment) add(&sum, *scene.environment);
  return digits(sum);
}

}  // namespace

std::string mesh_fingerprint(const Mesh& mesh) {
  Checksum sum;
  add_shape(&sum, mesh);
  add_shading(&sum, mesh);
  return digits(sum);
}

Fingerprint fingerprint(const Scene& scene) {
  return {geometry_of(scene), materials_of(scene), lights_of(scene)};
}

}  // namespace lte::scene
