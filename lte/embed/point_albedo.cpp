#include "lte/embed/point_albedo.h"

#include "lte/base/parallel.h"
#include "lte/scene/surface.h"

namespace lte::embed {
namespace {

constexpr float kReach = 1e-3f;  ///< of the scene's extent
constexpr Rgb kFreeAlbedo{0.5f, 0.5f, 0.5f};

}  // namespace

std::vector<Rgb> albedo_at(const pathtrace::Bvh& bvh, const SurfacePlaces& points) {
  std::vector<Rgb> albedo(points.position.size(), kFreeAlbedo);
  const float reach = kReach * length(bvh.bounds().extent());
  constexpr int64_t kGrain = 1024;
  parallel_for(static_cast<int64_t>(albedo.size()), kGrain, [&](int64_t begin, int64_t end) {
    for (auto i = static_cast<size_t>(begin); i < static_cast<size_t>(end); ++i) {
      const Vec3& normal = points.normal[i];
      const pathtrace::Hit hit =
          bvh.intersect({points.position[i] + reach * normal, -normal, 0, 2 * reach});
      if (!hit.valid()) continue;
      Rgb emission;
      scene::evaluate_appearance(bvh.scene(), hit.instance, hit.triangle, hit.u, hit.v,
                                 /*footprint=*/0, &albedo[i], &emission);
    }
  });
  return albedo;
}

}  // namespace lte::embed
