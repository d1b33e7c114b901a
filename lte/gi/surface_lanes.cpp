#include "lte/gi/surface_lanes.h"

#include <cmath>

#include "lte/base/vector_clones.h"
#include "lte/gi/surface_index.h"

namespace lte::gi {

LTE_VECTOR_CLONES
void weigh_lanes(const SurfaceLanes* __restrict lanes, int count, const Vec3& position,
                 const Vec3& normal, float* __restrict weights) {
  constexpr float kMin = SurfaceIndex::kMinCosine;
  constexpr float kFlat = 1 / (SurfaceIndex::kPlane * SurfaceIndex::kPlane);
  const Vec3 p = position, n = normal;
  for (int block = 0; block < count; ++block) {
    const SurfaceLanes& at = lanes[block];
    float* const out = weights + block * SurfaceLanes::kLanes;
    for (int i = 0; i < SurfaceLanes::kLanes; ++i) {
      const float dx = p.x - at.x[i], dy = p.y - at.y[i], dz = p.z - at.z[i];
      const float nx = at.normal_x[i], ny = at.normal_y[i], nz = at.normal_z[i];
      const float near = 1 - (dx * dx + dy * dy + dz * dz) * at.inverse_radius2[i];
      const float cosine = n.x * nx + n.y * ny + n.z * nz;
      const float off_point = std::fabs(dx * nx + dy * ny + dz * nz);
      const float off_place = std::fabs(dx * n.x + dy * n.y + dz * n.z);
      const float off = off_point > off_place ? off_point : off_place;
      const float flat = 1 - off * off * at.inverse_radius2[i] * kFlat;
      const float turned = (cosine - kMin) * (1 / (1 - kMin));
      const float weight = near * near * flat * turned;
      const bool speaks = (near > 0) & (flat > 0) & (turned > 0);
      out[i] = speaks ? weight : 0.0f;
    }
  }
}

}  // namespace lte::gi
