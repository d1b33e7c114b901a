#include "lte/scene/import/position_check.h"

#include "lte/base/check.h"

namespace lte::scene {

void check_world_positions(const std::string& file, const Scene& scene) {
  // Boxes stand for their vertices, as they contain them.
  std::vector<Bounds> boxes(scene.meshes.size());
  for (size_t i = 0; i < scene.meshes.size(); ++i) {
    for (const Vec3& p : scene.meshes[i].positions) boxes[i].extend(p);
  }
  for (const Instance& instance : scene.instances) {
    const Bounds& box = boxes[static_cast<size_t>(instance.mesh)];
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3 p{(corner & 1 ? box.high : box.low).x, (corner & 2 ? box.high : box.low).y,
                   (corner & 4 ? box.high : box.low).z};
      LTE_CHECK(is_finite(instance.to_world.point(p)), file, ": mesh \"",
                scene.meshes[static_cast<size_t>(instance.mesh)].name,
                "\" lies beyond the range of float in the world");
    }
  }
}

}  // namespace lte::scene
