// A guess of the light on surfaces, made to agree with what the scene does to light.
//
// A network's indirect light has the right shape and often not the right level: in rooms of other
// kinds than it was trained on it is off by a fifth over metres. A few rays measure how much of its
// light a scene passes on.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "lte/base/math.h"
#include "lte/gi/cache_geometry.h"
#include "lte/gi/cache_records.h"
#include "lte/gi/irradiance_cache.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/lights/lights.h"

namespace lte::gi {

/// Indirect irradiance in W/m² at places of the surfaces, [places], for records that are not
/// traced: what a network says there.
using IrradianceSource = std::function<std::vector<Rgb>(
    std::span<const Vec3> positions, std::span<const Vec3> normals, std::span<const Rgb> albedos)>;

struct LevelOptions {
  int rays = 4;       ///< a point of a record, of which it has up to kRecordPoints
  int max_depth = 5;  ///< surface hits of a path of light that a gather over the cache is to find
  uint64_t seed = 0;
};

/// Fills a cache by two gathers, one upon the other, over the direct light of records and a guess
/// of the indirect one, whose level is set beforehand.
///
/// The level: let K be one reflection by the scene, D direct light and f the guess. Gathered rays
/// at a part of the records measure Σ K D and λ = Σ K f / Σ f, one step of the power method. Light
/// of n bounces sums up to Σ K D (1 + λ + ... + λ^(n-1)), and f is scaled to that, by channel.
/// What is in the housings of lamps counts little. In a closed room whose walls shine evenly the
/// result is exact for any even guess.
///
/// @param geometry  of the records
/// @param direct  light of the records of depth 1
/// @param guess   asked once, for those records that direct light reaches or that lie beside such
///                along surfaces: two thirds of all are insides of walls and furniture
/// @return        the cache of direct light and what became of the guess
/// @throws lte::Error if sizes differ, a value is not finite, or a count is out of range.
IrradianceCache level_network_light(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                                    const std::shared_ptr<const CacheGeometry>& geometry,
                                    const CacheRecords& records, const RecordLight& direct,
                                    const IrradianceSource& guess, const LevelOptions& options);

}  // namespace lte::gi
