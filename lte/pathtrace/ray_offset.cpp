#include "lte/pathtrace/ray_offset.h"

#include <algorithm>

#include "lte/pathtrace/embree_scene.h"

namespace lte::pathtrace {

Vec3 offset_origin(const Vec3& position, const Vec3& side, float magnitude) {
  return position + side * (0x1p-20f * std::max(max_component(abs(position)), magnitude));
}

}  // namespace lte::pathtrace
