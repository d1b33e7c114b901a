// A guess of the light on surfaces, made to agree with what the scene does to light.
//
// A network's indirect light has the right shape and often not the right level: in rooms of other
// kinds than it was trained on it is off by a fifth over metres. A few rays measure how much of its
// light a scene passes on.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lte/base/math.h"
#include "lte/gi/cache_records.h"
#include "lte/gi/irradiance_cache.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/lights/lights.h"

namespace lte::gi {

struct LevelOptions {
  int rays = 4;       ///< a point of a record, of which it has up to kRecordPoints
  int max_depth = 5;  ///< surface hits of a path of light that a gather over the cache is to find
  uint64_t seed = 0;
};

/// Replaces the indirect light of records, a guess, by two gathers, one upon the other, over their
/// direct light and the guess, whose level is set beforehand.
///
/// The level: let K be one reflection by the scene, D direct light and f the guess. Gathered rays
/// at a part of the records measure Σ K D and λ = Σ K f / Σ f, one step of the power method. Light
/// of n bounces sums up to Σ K D (1 + λ + ... + λ^(n-1)), and f is scaled to that, by channel.
/// What is in the housings of lamps counts little. In a closed room whose walls shine evenly the
/// result is exact for any even guess.
///
/// @param light  of the records: direct light, and the guess in the place of indirect light
/// @return       the cache of direct light and what became of the guess
/// @throws lte::Error if sizes differ, a value is not finite, or a count is out of range.
IrradianceCache level_network_light(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                                    const CacheRecords& records, const RecordLight& light,
                                    const LevelOptions& options);

}  // namespace lte::gi
