// A final gather whose rays are kept apart: what each brings, and how far it goes.
#pragma once

#include <span>
#include <vector>

#include "lte/gi/gather.h"

namespace lte::experiments {

/// [points, rays] each.
struct RayGather {
  std::vector<Rgb> value;       ///< W/m²; their mean over the rays of a point is its estimate
  std::vector<float> distance;  ///< metres to what the ray meets first; infinite: nothing
};

/// The rays of gi::gather_irradiance() with the same arguments: their means are its result.
RayGather gather_rays(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                      const gi::IrradianceCache& cache, std::span<const Vec3> positions,
                      std::span<const Vec3> normals, const gi::GatherOptions& options);

}  // namespace lte::experiments
