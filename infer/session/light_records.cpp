#include "infer/session/light_records.h"

#include <algorithm>
#include <utility>

namespace lte::infer {

bool LightRecords::fit(const SceneEdits& edits, Method by) const {
  return filled_by == by && same_points(*drawn_for, edits);
}

LightRecords::Gains LightRecords::gains(const SceneEdits& edits) const {
  Gains out;
  for (size_t g = 0; g < drawn_for->settings.size(); ++g) {
    const int light = drawn_for->settings[g].label.id;
    const auto now = std::find_if(edits.settings.begin(), edits.settings.end(),
                                  [&](const LightSetting& s) { return s.label.id == light; });
    if (now == edits.settings.end() || max_component(now->scale()) <= 0) continue;
    out.groups.push_back(static_cast<int>(g));
    out.scales.push_back(now->scale());
  }
  return out;
}

std::shared_ptr<const gi::CacheGeometry> LightRecords::geometry(const SceneEdits& edits,
                                                                const pathtrace::Bvh& bvh) const {
  if (traced.geometry != nullptr && same_points(*drawn_for, edits)) return traced.geometry;
  return std::make_shared<const gi::CacheGeometry>(bvh, traced.places);
}

gi::RecordLight LightRecords::light(const SceneEdits& edits) const {
  const Gains some = gains(edits);
  return traced.light_of(some.groups, some.scales);
}

LightRecords trace_light_records(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                                 std::shared_ptr<const SceneEdits> edits, Method by,
                                 const render::CacheSettings& settings,
                                 const std::function<void()>& check) {
  return {std::move(edits), by, trace_records(bvh, lights, settings, by, check)};
}

std::shared_ptr<const gi::IrradianceCache> LazyCache::get() {
  std::call_once(made_, [this] { cache_ = std::make_shared<const gi::IrradianceCache>(make_()); });
  return cache_;
}

}  // namespace lte::infer
