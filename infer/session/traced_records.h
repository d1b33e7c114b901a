// Light on surfaces by light group, traced at unit gain: what caches are filled from while lamps
// are dimmed. Light is linear, so a cache of any gains is a sum of these records, exactly.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "lte/gi/cache_geometry.h"
#include "lte/gi/cache_records.h"
#include "lte/render/integrator.h"

namespace lte::infer {

struct TracedRecords {
  gi::CacheRecords places;
  std::shared_ptr<const gi::CacheGeometry> geometry;  ///< of these places; null without any
  int64_t groups = 0;
  std::vector<Rgb> direct;    ///< [groups, records], W/m²: depth 1
  std::vector<Rgb> indirect;  ///< [groups, records]: depths from 2 on; 0 where none were traced
  std::vector<Rgb> last;      ///< [groups, records]: of the last depth alone; or empty, likewise

  /// The light of some groups, each times its gain by channel, an entry each.
  /// @throws lte::Error for a group that there is not, or another number of gains.
  gi::RecordLight light_of(std::span<const int> of_groups, std::span<const Rgb> gains) const;
};

/// Traces what render::make_cache() of these settings has in its records, by light group: for
/// Method::Gather all light, by as many paths; for Method::Network the direct light alone.
/// @param lights  each as bright as gain 1 has it
/// @param check   called now and then; what it throws ends it. May be null.
TracedRecords trace_records(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                            const render::CacheSettings& settings, render::Method method,
                            const std::function<void()>& check = {});

}  // namespace lte::infer
