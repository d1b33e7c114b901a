// Incident radiance of some points of a scene, packed for the sample file.
#pragma once

#include <cstdint>
#include <functional>

#include "datagen/bake/bake.h"
#include "lte/data/incident_field.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/lights/lights.h"
#include "lte/scene/sampler.h"

namespace lte::datagen {

/// The number of paths that all points take together.
int64_t incident_paths(const IncidentBakeOptions& options);

/// Estimates incident radiance at each of `points`.
/// @param points  on the front side of their surfaces
/// @param done    is called with the number of paths whenever some are done
data::IncidentField bake_incident(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                                  const scene::SurfaceSamples& points,
                                  const IncidentBakeOptions& options, int max_depth, uint64_t seed,
                                  const std::function<void(int64_t paths)>& done);

}  // namespace lte::datagen
