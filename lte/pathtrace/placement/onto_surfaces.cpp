#include "lte/pathtrace/placement/onto_surfaces.h"

#include <atomic>
#include <cmath>

#include "lte/base/check.h"
#include "lte/base/parallel.h"
#include "lte/pathtrace/ray_offset.h"

namespace lte::pathtrace {
namespace {

constexpr float kReach = 1e-4f;        ///< of the extent
constexpr float kFacing = 0.5f;        ///< cosine between a surface's normal and that of a point
constexpr float kRounding = 0x1p-20f;  ///< of the extent, as offset_origin() has it

}  // namespace

int64_t move_onto_surfaces(const Bvh& bvh, std::span<const Vec3> normals,
                           std::vector<Vec3>* positions) {
  LTE_CHECK(normals.size() == positions->size(), "points to move: ", positions->size(),
            " positions but ", normals.size(), " normals");
  const float extent = max_component(bvh.bounds().extent());
  std::atomic<int64_t> moved{0};
  constexpr int64_t kGrain = 1024;
  parallel_for(static_cast<int64_t>(positions->size()), kGrain, [&](int64_t begin, int64_t end) {
    int64_t far = 0;
    for (int64_t i = begin; i < end; ++i) {
      Vec3& position = (*positions)[static_cast<size_t>(i)];
      const Vec3& normal = normals[static_cast<size_t>(i)];
      const Hit before = bvh.intersect({position, normal, 0, kReach * extent});
      if (!before.valid() || std::fabs(dot(before.normal, normal)) < kFacing) continue;
      // On a surface, or nearer to one behind it: of that it is a point.
      if (bvh.occluded({position, -normal, 0, before.t})) continue;
      position += before.t * normal;
      far += before.t > kRounding * extent ? 1 : 0;
    }
    moved += far;
  });
  return moved;
}

}  // namespace lte::pathtrace
