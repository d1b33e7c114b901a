// A radiosity table that a network has filled.
#pragma once

#include <cstdint>

#include "infer/light/embedding_draws.h"
#include "lte/gi/radiosity_table.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/lights/lights.h"

namespace lte::infer {

struct NetworkTableOptions {
  int64_t entries = 4096;  ///< where surfaces are level (gi::sample_entries())
  int direct_rays = 64;    ///< an entry
  uint64_t seed = 0;
};

/// Decodes indirect irradiance at points of the scene and adds direct light. Total models' answers
/// stand as they are, and have no noise that would keep all of it from saying where light is even.
gi::RadiosityTable network_table(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                                 const EmbeddingDraws& draws, const NetworkTableOptions& options);

}  // namespace lte::infer
