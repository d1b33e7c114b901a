#include "lte/pathtrace/irradiance.h"

#include "lte/pathtrace/transport/irradiance_kernel.h"

namespace lte::pathtrace {
namespace {

Rgb sum_groups(const std::vector<Rgb>& values, int64_t groups, int64_t points, int64_t point) {
  Rgb sum;
  for (int64_t g = 0; g < groups; ++g) sum += values[static_cast<size_t>(g * points + point)];
  return sum;
}

}  // namespace

Rgb Irradiance::direct_sum(int64_t point) const {
  return sum_groups(direct, groups, points, point);
}

Rgb Irradiance::indirect_sum(int64_t point) const {
  return sum_groups(indirect, groups, points, point);
}

Rgb Irradiance::total(int64_t point) const { return direct_sum(point) + indirect_sum(point); }

Irradiance estimate_irradiance(const Bvh& bvh, const Lights& lights,
                               std::span<const Vec3> positions, std::span<const Vec3> normals,
                               const IrradianceOptions& options, int64_t first_index) {
  return run_irradiance<NoObserver>(bvh, lights, positions, normals, options, first_index,
                                    [](int64_t) { return NoObserver{}; });
}

}  // namespace lte::pathtrace
