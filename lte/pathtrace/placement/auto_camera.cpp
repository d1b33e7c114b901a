#include "lte/pathtrace/placement/auto_camera.h"

namespace lte::pathtrace {

scene::Camera auto_camera(const Bvh& bvh, uint64_t seed, float aspect) {
  if (bvh.bounds().empty()) return outside_view(bvh, aspect);
  const FreeSpace space = survey(bvh);
  if (const auto camera = open_side_view(bvh, space, aspect)) return *camera;
  if (const auto camera = inside_view(bvh, space, seed)) return *camera;
  return outside_view(bvh, aspect);
}

}  // namespace lte::pathtrace
