// Irradiance at points by rays that end at records of a cache, where these know it.
#pragma once

#include "lte/render/integrator.h"

namespace lte::render {

/// @param cache      may be empty: then every ray goes on to a path's end
/// @param max_depth  surface hits of a path of light after the point
/// @throws lte::Error as Integrator::irradiance()
PointIrradiance gather_points(const TracedScene& scene, const gi::IrradianceCache& cache,
                              const SurfacePoints& points, const PointSampling& sampling,
                              int max_depth);

}  // namespace lte::render
