#include "infer/session/light_layer.h"

#include <algorithm>
#include <set>
#include <tuple>
#include <utility>

#include "lte/base/timer.h"
#include "lte/embed/point_light.h"
#include "lte/embed/scene_points.h"

namespace lte::infer {
namespace {

// Of Accuracy::Coarse: one of so many points.
constexpr int64_t kDraftShare = 2;

std::set<int> shining_suns(const SceneEdits& edits) {
  std::set<int> groups;
  for (const scene::PunctualLight& light : edits.lights) {
    if (light.kind == scene::LightKind::Directional && max_component(light.intensity) > 0)
      groups.insert(light.light_group);
  }
  return groups;
}

/// The points that a network sees beside the light of `groups`. Those of a sun that it was not
/// trained with are left out unless nothing else shines, as drop_untrained_suns() has it.
std::vector<size_t> rows_of(const SceneEdits& edits, const scene::SurfaceSamples& surface,
                            const std::vector<int>& groups, const runtime::Network& network) {
  std::set<int> seen(groups.begin(), groups.end());
  if (!network.metadata().suns) {
    const std::set<int> suns = shining_suns(edits);
    const bool others = std::any_of(seen.begin(), seen.end(),
                                    [&](const int group) { return !suns.contains(group); });
    if (others) std::erase_if(seen, [&](const int group) { return suns.contains(group); });
  }
  std::vector<size_t> rows;
  for (size_t i = 0; i < surface.light_group.size(); ++i) {
    const int group = surface.light_group[i];
    if (group == scene::kNone || seen.contains(group)) rows.push_back(i);
  }
  return rows;
}

template <typename T>
std::vector<T> select(const std::vector<T>& values, const std::vector<size_t>& rows,
                      size_t columns = 1) {
  std::vector<T> out;
  if (values.empty()) return out;
  out.reserve(rows.size() * columns);
  for (const size_t row : rows) {
    for (size_t c = 0; c < columns; ++c) out.push_back(values[row * columns + c]);
  }
  return out;
}

scene::SurfaceSamples select(const scene::SurfaceSamples& surface,
                             const std::vector<size_t>& rows) {
  scene::SurfaceSamples out;
  out.position = select(surface.position, rows);
  out.normal = select(surface.normal, rows);
  out.albedo = select(surface.albedo, rows);
  out.emission = select(surface.emission, rows);
  out.gloss = select(surface.gloss, rows);
  out.area = select(surface.area, rows);
  out.light_group = select(surface.light_group, rows);
  return out;
}

/// Of [G, M] values the rows of some groups.
template <typename T>
std::vector<T> groups_of(const std::vector<T>& values, size_t points,
                         const std::vector<int>& groups) {
  std::vector<T> out;
  out.reserve(points * groups.size());
  for (const int group : groups) {
    const auto from = values.begin() + static_cast<ptrdiff_t>(points * static_cast<size_t>(group));
    out.insert(out.end(), from, from + static_cast<ptrdiff_t>(points));
  }
  return out;
}

/// Multiplies the rows of [G, M] values by the gain of each group.
void scale_rows(const std::vector<Rgb>& gains, size_t points, std::vector<Rgb>* values) {
  for (size_t i = 0; i < values->size(); ++i) (*values)[i] *= gains[i / points];
}

data::PointIrradiance sum_of(const pathtrace::LightEstimates& light, size_t points,
                             const std::vector<int>& groups, const std::vector<Rgb>& gains,
                             const runtime::LightRequest& input) {
  pathtrace::LightEstimates some;
  some.direct = groups_of(light.direct, points, groups);
  some.indirect = groups_of(light.indirect, points, groups);
  some.direct_back = groups_of(light.direct_back, points, groups);
  some.indirect_back = groups_of(light.indirect_back, points, groups);
  some.error = groups_of(light.error, points, groups);
  some.error_back = groups_of(light.error_back, points, groups);
  if (!gains.empty()) {
    for (std::vector<Rgb>* values :
         {&some.direct, &some.indirect, &some.direct_back, &some.indirect_back})
      scale_rows(gains, points, values);
  }
  return data::sum_groups(embed::light_to_read(some, input), static_cast<int64_t>(groups.size()));
}

}  // namespace

GroupedPoints draw_points(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                          const runtime::Network& network, const EmbedSettings& settings,
                          const PointsBefore& before, Accuracy accuracy,
                          const std::function<void()>& check, EditReport* report) {
  const bool whole = accuracy == Accuracy::Full;
  const int64_t all = embed::scene_point_count(bvh, network, settings);
  const int64_t count = whole ? all : std::max<int64_t>(1, all / kDraftShare);
  const bool prune = settings.prunes(network);
  GroupedPoints out;
  Timer timer;
  pathtrace::ReachRecall recall{before.points != nullptr ? &before.points->reach : nullptr,
                                before.changed, &out.reach};
  recall.check = check;
  out.surface = embed::sample_scene_points(bvh, count, prune, settings.seed, &out.pruned, recall,
                                           settings.culled_lights);
  report->points_ms += 1e3 * timer.seconds();
  report->points_drawn += std::max(out.surface.size(), out.pruned.drawn);
  const runtime::LightRequest input = network.light_request();
  if (input.depth == 0) return out;
  timer.restart();
  const scene::SurfaceSamples& s = out.surface;
  out.light = pathtrace::estimate_light(
      bvh, lights, s.position, s.normal, s.emission,
      {.paths = input.paths, .max_depth = input.depth, .seed = settings.seed, .check = check});
  report->light_ms += 1e3 * timer.seconds();
  return out;
}

std::vector<LightGroups> layers_apart(const SceneEdits& edits) {
  std::vector<LightGroups> layers(1);
  for (size_t g = 0; g < edits.settings.size(); ++g) {
    if (edits.settings[g].touched) {
      layers.push_back({{static_cast<int>(g)}});
    } else {
      layers.front().groups.push_back(static_cast<int>(g));
    }
  }
  std::erase_if(layers, [&](const LightGroups& layer) {
    return std::all_of(layer.groups.begin(), layer.groups.end(), [&](const int group) {
      return edits.settings[static_cast<size_t>(group)].brightness <= 0;
    });
  });
  return layers;
}

std::vector<LightGroups> layers_together(const SceneEdits& edits) {
  LightGroups all{{}, /*as_dimmed=*/true};
  for (size_t g = 0; g < edits.settings.size(); ++g) {
    const LightSetting& setting = edits.settings[g];
    if (setting.brightness > 0 && max_component(setting.scale()) > 0)
      all.groups.push_back(static_cast<int>(g));
  }
  if (all.groups.empty()) return {};
  return {all};
}

namespace {

/// The numbers of a layer's luminaires and, where they are encoded as dimmed, the gains.
std::pair<std::vector<int>, std::vector<Rgb>> lights_of(const SceneEdits& edits,
                                                        const LightGroups& layer) {
  std::pair<std::vector<int>, std::vector<Rgb>> out;
  for (const int group : layer.groups) {
    const LightSetting& setting = edits.settings[static_cast<size_t>(group)];
    out.first.push_back(setting.label.id);
    if (layer.as_dimmed) out.second.push_back(setting.scale());
  }
  return out;
}

}  // namespace

bool LightLayer::is(const SceneEdits& edits, const LightGroups& wanted) const {
  return lights_of(edits, wanted) == std::pair(lights, gains);
}

std::shared_ptr<const LightLayer> encode_layer(const SceneEdits& edits,
                                               std::shared_ptr<const GroupedPoints> drawn,
                                               const LightGroups& wanted,
                                               const runtime::Network& network,
                                               const EmbedSettings& settings) {
  auto layer = std::make_shared<LightLayer>();
  layer->points = std::move(drawn);
  std::tie(layer->lights, layer->gains) = lights_of(edits, wanted);
  const GroupedPoints& points = *layer->points;
  const std::vector<int>& groups = wanted.groups;
  const size_t count = points.surface.position.size();
  const std::vector<size_t> rows = rows_of(edits, points.surface, groups, network);
  embed::LitSamples lit;
  if (points.light)
    lit.light = sum_of(*points.light, count, groups, layer->gains, network.light_request());
  runtime::EncodeOptions options{settings.rescale, {}, settings.memory};
  if (rows.size() == count) {
    lit.surface = points.surface;
  } else {
    lit.surface = select(points.surface, rows);
    lit.light.direct = select(lit.light.direct, rows);
    lit.light.indirect = select(lit.light.indirect, rows);
    lit.light.direct_back = select(lit.light.direct_back, rows);
    lit.light.indirect_back = select(lit.light.indirect_back, rows);
    lit.light.error = select(lit.light.error, rows, 2);
    // All layers see the scene in the same place.
    if (groups.size() < edits.settings.size()) {
      Bounds bounds;
      for (const Vec3& position : points.surface.position) bounds.extend(position);
      options.origin = bounds.low;
    }
  }
  if (wanted.as_dimmed) {
    for (size_t i = 0; i < lit.surface.emission.size(); ++i) {
      const int group = lit.surface.light_group[i];
      if (group != scene::kNone)
        lit.surface.emission[i] *= edits.settings[static_cast<size_t>(group)].scale();
    }
  }
  layer->embedding =
      std::make_shared<const runtime::SceneEmbedding>(network, lit.points(), options);
  return layer;
}

}  // namespace lte::infer
