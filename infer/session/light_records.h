// What a session's gathered pictures read: light on surfaces by luminaire, and caches of some gains
// that are made from it when a picture first needs them.
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "infer/session/scene_edits.h"
#include "infer/session/traced_records.h"
#include "lte/gi/irradiance_cache.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/lights/lights.h"

namespace lte::infer {

/// Records of a scene whose luminaires all have gain 1.
struct LightRecords {
  std::shared_ptr<const SceneEdits> drawn_for;
  Method filled_by = Method::Gather;  ///< Network: direct light alone, at all records
  TracedRecords traced;

  /// Whether they hold for an edited scene: that differs from theirs by gains and colors alone.
  bool fit(const SceneEdits& edits, Method by) const;
  /// What stands around the records in an edited scene: it is known where they fit.
  std::shared_ptr<const gi::CacheGeometry> geometry(const SceneEdits& edits,
                                                    const pathtrace::Bvh& bvh) const;
  /// The light on the records with the gains that luminaires of these numbers have in an edited
  /// scene. Those that the edited scene has not are dark; those that the records have not bring
  /// nothing.
  gi::RecordLight light(const SceneEdits& edits) const;

 private:
  struct Gains {
    std::vector<int> groups;
    std::vector<Rgb> scales;
  };
  Gains gains(const SceneEdits& edits) const;
};

/// @param settings  with the seed of the places and their light
/// @param check  called now and then; what it throws ends it. May be null.
LightRecords trace_light_records(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                                 std::shared_ptr<const SceneEdits> edits, Method by,
                                 const render::CacheSettings& settings,
                                 const std::function<void()>& check);

/// A cache that is made when it is first read: of the states that a slider passes through, few are
/// rendered. Thread-safe.
class LazyCache {
 public:
  explicit LazyCache(std::function<gi::IrradianceCache()> make) : make_(std::move(make)) {}

  std::shared_ptr<const gi::IrradianceCache> get();

 private:
  std::function<gi::IrradianceCache()> make_;
  std::once_flag made_;
  std::shared_ptr<const gi::IrradianceCache> cache_;
};

}  // namespace lte::infer
