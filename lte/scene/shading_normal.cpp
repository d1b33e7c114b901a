#include "lte/scene/shading_normal.h"

#include <cmath>

#include "lte/scene/texture_lookup.h"

namespace lte::scene {
namespace {

constexpr float kZeroCode = 128.0f / 255.0f;

/// Directions of a normal map's axes in the world; `x` is zero where none is known.
struct Axes {
  Vec3 x, y, z;
};

/// The mesh's own normal, to the world by the cofactors of its transform; `front` where there is
/// none, or one that points behind the surface.
Vec3 base_normal(const Mesh& mesh, const Affine& to_world, uint32_t triangle, const Barycentric& b,
                 const Vec3& front) {
  if (mesh.normals.empty()) return front;
  const auto& corner = mesh.triangles[triangle];
  const Vec3 n = b.mix(mesh.normals[corner[0]], mesh.normals[corner[1]], mesh.normals[corner[2]]);
  const Vec3 x = to_world.vector({1, 0, 0}), y = to_world.vector({0, 1, 0}),
             z = to_world.vector({0, 0, 1});
  const float side = to_world.determinant() < 0 ? -1.0f : 1.0f;
  const Vec3 world = normalize((cross(y, z) * n.x + cross(z, x) * n.y + cross(x, y) * n.z) * side);
  return dot(world, front) > 0 ? world : front;
}

/// Directions in which U and the rows upwards grow over a triangle, of any length.
void texture_directions(const Mesh& mesh, const Affine& to_world, uint32_t triangle,
                        const TextureRef& ref, Vec3* along, Vec3* up) {
  const auto& corner = mesh.triangles[triangle];
  const std::vector<Vec2>& uvs = mesh.uvs[static_cast<size_t>(ref.uv_set)];
  const Vec2 uv = ref.transform(uvs[corner[0]]), uv1 = ref.transform(uvs[corner[1]]),
             uv2 = ref.transform(uvs[corner[2]]);
  const float u1 = uv1.x - uv.x, v1 = uv1.y - uv.y, u2 = uv2.x - uv.x, v2 = uv2.y - uv.y;
  const Vec3& p = mesh.positions[corner[0]];
  const Vec3 edge1 = to_world.vector(mesh.positions[corner[1]] - p),
             edge2 = to_world.vector(mesh.positions[corner[2]] - p);
  const float side = u1 * v2 - u2 * v1 < 0 ? -1.0f : 1.0f;
  *along = (edge1 * v2 - edge2 * v1) * side;
  *up = (edge1 * u2 - edge2 * u1) * side;  // V grows downwards
}

Axes axes_at(const Scene& scene, const Instance& placed, uint32_t triangle, const Barycentric& b,
             const TextureRef& ref, const Vec3& front) {
  const Mesh& mesh = scene.meshes[static_cast<size_t>(placed.mesh)];
  Axes out;
  out.z = base_normal(mesh, placed.to_world, triangle, b, front);
  Vec3 along, up;
  float sign = 1;
  if (mesh.tangents.empty()) {
    texture_directions(mesh, placed.to_world, triangle, ref, &along, &up);
    if (dot(cross(out.z, along), up) < 0) sign = -1;
  } else {
    const auto& corner = mesh.triangles[triangle];
    const Tangent &a = mesh.tangents[corner[0]], &c = mesh.tangents[corner[1]],
                  &d = mesh.tangents[corner[2]];
    along = placed.to_world.vector(b.mix(a.direction, c.direction, d.direction));
    sign = placed.to_world.determinant() < 0 ? -a.sign : a.sign;
  }
  along = normalize(along);
  out.x = normalize(along - out.z * dot(out.z, along));
  out.y = cross(out.z, out.x) * sign;
  return out;
}

}  // namespace

bool has_normal_map(const Scene& scene, const Instance& instance) {
  const Mesh& mesh = scene.meshes[static_cast<size_t>(instance.mesh)];
  const TextureRef& ref = scene.materials[static_cast<size_t>(mesh.material)].normal_texture;
  return ref.texture != kNone && !mesh.uvs[static_cast<size_t>(ref.uv_set)].empty();
}

Vec3 shading_normal(const Scene& scene, int instance, uint32_t triangle, float u, float v,
                    float footprint, const Vec3& front) {
  const Instance& placed = scene.instances[static_cast<size_t>(instance)];
  const Mesh& mesh = scene.meshes[static_cast<size_t>(placed.mesh)];
  const Material& material = scene.materials[static_cast<size_t>(mesh.material)];
  const Barycentric b{1 - u - v, u, v};
  const Axes axes = axes_at(scene, placed, triangle, b, material.normal_texture, front);
  const Rgb texel = TextureLookup(scene, instance, triangle, footprint)(material.normal_texture, b);
  const float x = 2 * (texel.x - kZeroCode) * material.normal_scale,
              y = 2 * (texel.y - kZeroCode) * material.normal_scale;
  const bool flat = x == 0 && y == 0;
  if (flat || !(dot(axes.x, axes.x) > 0)) return axes.z;
  const Vec3 bent = normalize(axes.x * x + axes.y * y + axes.z * (2 * texel.z - 1));
  return dot(bent, bent) > 0 ? bent : axes.z;
}

}  // namespace lte::scene
