#include "lte/embed/point_albedo.h"

#include "lte/base/parallel_each.h"
#include "lte/scene/surface.h"

namespace lte::embed {
namespace {

constexpr float kReach = 1e-3f;  ///< of the scene's extent
constexpr Rgb kFreeAlbedo{0.5f, 0.5f, 0.5f};

}  // namespace

std::vector<Rgb> albedo_at(const pathtrace::Bvh& bvh, const SurfacePlaces& points) {
  std::vector<Rgb> albedo(points.position.size(), kFreeAlbedo);
  const float reach = kReach * length(bvh.bounds().extent());
  parallel_each(albedo.size(), 1024, [&](size_t i) {
    const Vec3& normal = points.normal[i];
    const pathtrace::Hit hit =
        bvh.intersect({points.position[i] + reach * normal, -normal, 0, 2 * reach});
    if (!hit.valid()) return;
    Rgb emission;
    scene::evaluate_appearance(bvh.scene(), hit.instance, hit.triangle, hit.u, hit.v,
                               /*footprint=*/0, &albedo[i], &emission);
  });
  return albedo;
}

}  // namespace lte::embed
