#include "lte/scene/scene.h"

#include <cmath>

#include "lte/scene/camera_rays.h"

namespace lte::scene {

Vec2 TextureRef::transform(const Vec2& uv) const {
  const float x = uv.x * scale.x, y = uv.y * scale.y;
  if (rotation == 0) return {x + offset.x, y + offset.y};
  // V points down, so a rotation that the eye sees as counter-clockwise has this sign.
  const float c = std::cos(rotation), s = std::sin(rotation);
  return {c * x + s * y + offset.x, -s * x + c * y + offset.y};
}

Vec3 Camera::direction(float x, float y, float aspect) const {
  return CameraRays(*this).direction(x, y, aspect);
}

int64_t Scene::triangle_count() const {
  int64_t count = 0;
  for (const Instance& instance : instances) {
    count += static_cast<int64_t>(meshes[instance.mesh].triangles.size());
  }
  return count;
}

Bounds Scene::bounds() const {
  Bounds out;
  for (const Instance& instance : instances) {
    const Mesh& mesh = meshes[instance.mesh];
    for (const std::array<uint32_t, 3>& triangle : mesh.triangles) {
      for (const uint32_t corner : triangle) {
        out.extend(instance.to_world.point(mesh.positions[corner]));
      }
    }
  }
  return out;
}

}  // namespace lte::scene
