#include "infer/session/state.h"

#include <algorithm>
#include <utility>

#include "infer/light/untrained_light.h"
#include "lte/base/check.h"
#include "lte/base/timer.h"

namespace lte::infer {
namespace {

std::vector<int> tree_of_mesh(const Draft& draft) {
  std::vector<int> out;
  for (const MeshUse& use : draft.meshes) out.push_back(use.base);
  return out;
}

/// A scene with its tree and lights.
struct Traced {
  std::shared_ptr<const scene::Scene> scene;
  std::shared_ptr<const pathtrace::Bvh> bvh;
  std::shared_ptr<const pathtrace::Lights> lights;
};

Traced trace(const SessionBase& base, const Draft& draft, bool lit, EditReport* report) {
  Traced out;
  Timer timer;
  out.scene = std::make_shared<const scene::Scene>(make_scene(base.scene, draft, lit));
  report->scene_ms += 1e3 * timer.seconds();
  timer.restart();
  out.bvh = std::make_shared<const pathtrace::Bvh>(*out.scene, *base.trees, tree_of_mesh(draft));
  report->bvh_ms += 1e3 * timer.seconds();
  timer.restart();
  out.lights = std::make_shared<const pathtrace::Lights>(*out.scene);
  report->scene_ms += 1e3 * timer.seconds();
  return out;
}

bool is_scaled(const Draft& draft) {
  return std::any_of(draft.settings.begin(), draft.settings.end(),
                     [](const LightSetting& s) { return s.gain != 1 || s.color.has_value(); });
}

std::shared_ptr<const LightLayer> find_layer(const SessionState::Parts* before,
                                             const std::shared_ptr<const GroupedPoints>& points,
                                             const std::vector<int>& lights) {
  if (before == nullptr) return nullptr;
  for (const ScaledLayer& each : before->layers) {
    if (each.layer->points == points && each.layer->lights == lights) return each.layer;
  }
  return nullptr;
}

void add_layers(const std::vector<std::vector<int>>& partition, const SessionState::Parts* before,
                SessionState::Parts* parts, EditReport* report) {
  const Draft& draft = *parts->draft;
  for (const std::vector<int>& groups : partition) {
    std::vector<int> lights;
    for (const int group : groups)
      lights.push_back(draft.settings[static_cast<size_t>(group)].label.id);
    std::shared_ptr<const LightLayer> layer = find_layer(before, parts->points, lights);
    if (layer == nullptr) {
      const Timer timer;
      auto made = std::make_shared<LightLayer>();
      made->points = parts->points;
      made->lights = std::move(lights);
      made->embedding = encode_groups(draft, *parts->points, groups, *parts->base->network,
                                      parts->base->settings.embedding);
      layer = std::move(made);
      report->encode_ms += 1e3 * timer.seconds();
      ++report->encodings;
    }
    const LightSetting& setting = draft.settings[static_cast<size_t>(groups.front())];
    parts->layers.push_back({std::move(layer), setting.scale()});
  }
  report->layers = static_cast<int>(parts->layers.size());
}

}  // namespace

std::vector<std::vector<int>> partition(const Draft& draft) {
  std::vector<std::vector<int>> parts(1);
  for (size_t g = 0; g < draft.settings.size(); ++g) {
    if (draft.settings[g].touched) {
      parts.push_back({static_cast<int>(g)});
    } else {
      parts.front().push_back(static_cast<int>(g));
    }
  }
  std::erase_if(parts, [&](const std::vector<int>& groups) {
    return std::all_of(groups.begin(), groups.end(), [&](const int group) {
      return draft.settings[static_cast<size_t>(group)].brightness <= 0;
    });
  });
  return parts;
}

SessionBase::SessionBase(scene::Scene first, std::optional<runtime::Network> with,
                         SessionSettings how)
    : scene(std::move(first)),
      trees(pathtrace::Bvh::with_own_meshes(scene)),
      network(std::move(with)),
      settings(std::move(how)) {}

std::unique_ptr<SessionState::Parts> make_parts(std::shared_ptr<const SessionBase> base,
                                                std::shared_ptr<const Draft> draft,
                                                const SessionState::Parts* before,
                                                EditReport* report) {
  auto parts = std::make_unique<SessionState::Parts>();
  parts->base = std::move(base);
  parts->draft = std::move(draft);
  const Draft& now = *parts->draft;
  Traced shown = trace(*parts->base, now, /*lit=*/true, report);
  parts->scene = shown.scene;
  parts->bvh = shown.bvh;
  parts->lights = shown.lights;
  const bool geometry = before == nullptr || !same_geometry(*before->draft, now);
  report->bvh_rebuilt = geometry;
  parts->geometry_version = (before != nullptr ? before->geometry_version : 0) + (geometry ? 1 : 0);
  parts->version = (before != nullptr ? before->version : 0) + 1;
  report->version = parts->version;
  const std::optional<runtime::Network>& network = parts->base->network;
  const bool known = network && (parts->base->settings.untrained_light ||
                                 !has_untrained_light(*parts->scene, network->metadata()));
  parts->asks_network = known;
  if (!known) return parts;
  const std::vector<std::vector<int>> layers = partition(now);
  if (layers.empty()) return parts;
  if (before != nullptr && before->points != nullptr && same_points(*before->draft, now)) {
    parts->points = before->points;
  } else {
    const Traced at_gain_1 =
        is_scaled(now) ? trace(*parts->base, now, /*lit=*/false, report) : std::move(shown);
    PointsBefore points;
    if (before != nullptr && before->points != nullptr) {
      if (auto changed = changed_places(parts->base->scene, *before->draft, now))
        points = {before->points.get(), std::move(*changed)};
    }
    parts->points = std::make_shared<const GroupedPoints>(
        draw_points(*at_gain_1.bvh, *at_gain_1.lights, *network, parts->base->settings.embedding,
                    points, report));
  }
  add_layers(layers, before, parts.get(), report);
  return parts;
}

std::vector<Rgb> SessionState::Parts::answer(const runtime::QueryPoints& queries) const {
  std::vector<Rgb> sum(queries.position.size());
  for (const ScaledLayer& each : layers) {
    if (max_component(each.scale) <= 0) continue;
    const std::vector<Rgb> part = each.layer->embedding->decode(queries);
    for (size_t i = 0; i < sum.size(); ++i) sum[i] += part[i] * each.scale;
  }
  return sum;
}

}  // namespace lte::infer
