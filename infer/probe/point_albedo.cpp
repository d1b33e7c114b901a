#include "infer/probe/point_albedo.h"

#include "lte/scene/surface.h"

namespace lte::infer {

PointAlbedo albedo_at(const pathtrace::Bvh& bvh, const scene::PointTable& points) {
  PointAlbedo out;
  const float reach = kSurfaceDistance * length(bvh.bounds().extent());
  for (size_t i = 0; i < points.size(); ++i) {
    const Vec3& n = points.normal[i];
    const pathtrace::Hit hit = bvh.intersect({points.position[i] + n * reach, -n, 0, 2 * reach});
    Rgb albedo = kFreeAlbedo, emission;
    if (hit.valid()) {
      scene::evaluate_appearance(bvh.scene(), hit.instance, hit.triangle, hit.u, hit.v, 0, &albedo,
                                 &emission);
    } else {
      ++out.off_surface;
    }
    out.albedo.push_back(albedo);
  }
  return out;
}

}  // namespace lte::infer
