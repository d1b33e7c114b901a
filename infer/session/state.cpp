#include "infer/session/state.h"

#include <algorithm>
#include <utility>

#include "lte/base/check.h"
#include "lte/base/timer.h"
#include "lte/embed/embed.h"
#include "lte/embed/untrained_light.h"

namespace lte::infer {
namespace {

std::vector<int> tree_of_mesh(const SceneEdits& edits) {
  std::vector<int> out;
  for (const MeshUse& use : edits.meshes) out.push_back(use.base);
  return out;
}

bool is_scaled(const SceneEdits& edits) {
  return std::any_of(edits.settings.begin(), edits.settings.end(),
                     [](const LightSetting& s) { return s.gain != 1 || s.color.has_value(); });
}

std::shared_ptr<const LightLayer> find_layer(const SessionState::Parts* before,
                                             const std::shared_ptr<const GroupedPoints>& points,
                                             const SceneEdits& edits, const LightGroups& wanted) {
  if (before == nullptr) return nullptr;
  for (const ScaledLayer& each : before->layers) {
    if (each.layer->points == points && each.layer->is(edits, wanted)) return each.layer;
  }
  return nullptr;
}

std::vector<Rgb> sum_of(const std::vector<ScaledLayer>& layers,
                        const runtime::QueryPoints& queries) {
  std::vector<Rgb> sum(queries.position.size());
  for (const ScaledLayer& each : layers) {
    if (max_component(each.scale) <= 0) continue;
    const std::vector<Rgb> part = each.layer->embedding->decode(queries);
    for (size_t i = 0; i < sum.size(); ++i) sum[i] += part[i] * each.scale;
  }
  return sum;
}

/// Of states of one edited scene.
bool same_answers(const SessionState::Parts& a, const SessionState::Parts& b) {
  const auto same = [](const ScaledLayer& s, const ScaledLayer& t) {
    return s.layer == t.layer && s.scale == t.scale;
  };
  return a.asks_network == b.asks_network && a.accuracy == b.accuracy && a.records == b.records &&
         std::equal(a.layers.begin(), a.layers.end(), b.layers.begin(), b.layers.end(), same);
}

/// Finds the light of a state whose scene is there.
class Lighting {
 public:
  Lighting(const SessionState::Parts* before, const Wanted& wanted, SessionState::Parts* parts,
           EditReport* report)
      : before_(before),
        wanted_(wanted),
        parts_(*parts),
        edits_(*parts->edits),
        network_(*parts->base->network),
        report_(*report) {}

  void run() {
    if (before_ != nullptr) {
      parts_.full_points = before_->full_points;
      parts_.coarse_points = before_->coarse_points;
      if (looks()) parts_.culled_lights = before_->culled_lights;
    }
    parts_.asks_network = knows_light();
    if (parts_.asks_network) find_light();
  }

 private:
  /// Whether the network was trained with all kinds of light that it reads.
  bool knows_light() {
    const runtime::ModelMetadata& model = network_.metadata();
    if (!embed::has_untrained_light(*parts_.scene, model)) return true;
    if (!looks()) return false;
    find_culled_lights();  // before anything is kept: paths may have to answer
    return !embed::has_untrained_light(*parts_.scene, model, culled_lights());
  }

  void find_light() {
    if (layers_apart(edits_).empty()) return;
    const bool keeps = before_ != nullptr && !before_->layers.empty();
    if (looks() && !knows_culled_lights()) {
      if (wanted_.least == Accuracy::Kept && keeps) return keep_layers();
      find_culled_lights();
    }
    const std::vector<LightGroups> apart =
        without_groups(layers_apart(edits_), edits_, culled_lights());
    if (apart.empty()) return;  // nothing that reaches what is seen
    const bool known = fit(parts_.full_points);
    const bool free = known && std::all_of(apart.begin(), apart.end(), [&](const auto& layer) {
                        return find_layer(before_, parts_.full_points, edits_, layer) != nullptr;
                      });
    if (wanted_.least == Accuracy::Kept && keeps && !free) {
      keep_layers();
    } else if (wanted_.least == Accuracy::Full || known) {
      make(Accuracy::Full, apart, &parts_.full_points);
    } else {
      light_coarsely();
    }
  }

  /// Whether lights that do not reach what is seen are culled.
  bool looks() const {
    return !parts_.cameras.empty() && parts_.base->settings.embedding.prunes(network_);
  }

  bool knows_culled_lights() const {
    return parts_.culled_lights != nullptr && parts_.culled_lights->fits(edits_, parts_.cameras);
  }

  void find_culled_lights() {
    if (knows_culled_lights()) return;
    if (wanted_.check) wanted_.check();
    const Traced& scene = at_gain_1();
    const Timer timer;
    CulledLights found{parts_.edits, parts_.cameras, {}};
    for (const int group : embed::culled_lights(*scene.bvh, network_,
                                                parts_.base->settings.embedding, parts_.cameras))
      found.lights.push_back(edits_.settings[static_cast<size_t>(group)].label.id);
    parts_.culled_lights = std::make_shared<const CulledLights>(std::move(found));
    report_.points_ms += 1e3 * timer.seconds();
  }

  std::vector<int> culled_lights() const {
    return parts_.culled_lights ? groups_of(edits_, parts_.culled_lights->lights)
                                : std::vector<int>();
  }

  std::vector<int> culled_numbers() const {
    return parts_.culled_lights ? parts_.culled_lights->lights : std::vector<int>();
  }

  /// Whether points describe what the network should read: drawn for this scene or one that
  /// differs by gains and colors alone, and without the same luminaires.
  bool fit(const std::shared_ptr<const GroupedPoints>& points) const {
    return points != nullptr && same_points(*points->drawn_for, edits_) &&
           points->culled == culled_numbers();
  }

  const Traced& at_gain_1() {
    if (!at_gain_1_) {
      at_gain_1_ = is_scaled(edits_) ? trace(*parts_.base, edits_, /*lit=*/false, &report_)
                                     : Traced{parts_.scene, parts_.bvh, parts_.lights};
    }
    return *at_gain_1_;
  }

  void light_coarsely() {
    make(Accuracy::Coarse, without_groups(layers_together(edits_), edits_, culled_lights()),
         &parts_.coarse_points);
  }

  void make(Accuracy accuracy, const std::vector<LightGroups>& layers,
            std::shared_ptr<const GroupedPoints>* points) {
    parts_.accuracy = accuracy;
    if (!fit(*points)) *points = draw(accuracy, *points);
    for (const LightGroups& groups : layers) {
      std::shared_ptr<const LightLayer> layer = find_layer(before_, *points, edits_, groups);
      if (layer == nullptr) {
        if (wanted_.check) wanted_.check();
        const Timer timer;
        layer = encode_layer(edits_, *points, groups, network_, parts_.base->settings.embedding);
        report_.encode_ms += 1e3 * timer.seconds();
        ++report_.encodings;
      }
      const LightSetting& setting = edits_.settings[static_cast<size_t>(groups.groups.front())];
      parts_.layers.push_back(
          {std::move(layer), groups.as_dimmed ? Rgb{1, 1, 1} : setting.scale()});
    }
  }

  std::shared_ptr<const GroupedPoints> draw(Accuracy accuracy,
                                            const std::shared_ptr<const GroupedPoints>& last) {
    const Traced& scene = at_gain_1();
    EmbedSettings settings = parts_.base->settings.embedding;
    settings.culled_lights = culled_lights();
    PointsBefore recalled;
    // What was dark may not be so to other luminaires.
    if (last != nullptr && last->culled == culled_numbers()) {
      if (auto changed = changed_places(parts_.base->scene, *last->drawn_for, edits_))
        recalled = {last.get(), std::move(*changed)};
    }
    auto points =
        std::make_shared<GroupedPoints>(draw_points(*scene.bvh, *scene.lights, network_, settings,
                                                    recalled, accuracy, wanted_.check, &report_));
    points->drawn_for = parts_.edits;
    points->culled = culled_numbers();
    return points;
  }

  /// Those of before, but for luminaires that have gone. One that has a layer of its own is as
  /// bright as it is now.
  void keep_layers() {
    parts_.accuracy = Accuracy::Kept;
    const auto setting_of = [&](int light) {
      return std::find_if(edits_.settings.begin(), edits_.settings.end(),
                          [&](const LightSetting& s) { return s.label.id == light; });
    };
    for (ScaledLayer kept : before_->layers) {
      const std::vector<int>& lights = kept.layer->lights;
      const bool gone = std::all_of(lights.begin(), lights.end(), [&](const int light) {
        return setting_of(light) == edits_.settings.end();
      });
      if (gone) continue;
      if (lights.size() == 1 && kept.layer->gains.empty())
        kept.scale = setting_of(lights.front())->scale();
      parts_.layers.push_back(std::move(kept));
    }
    if (!parts_.layers.empty()) return;
    if (looks()) find_culled_lights();
    light_coarsely();
  }

  const SessionState::Parts* before_;
  const Wanted& wanted_;
  SessionState::Parts& parts_;
  const SceneEdits& edits_;
  const runtime::Network& network_;
  EditReport& report_;
  std::optional<Traced> at_gain_1_;
};

render::CacheSettings cache_settings(const SessionBase& base) {
  render::CacheSettings out = base.settings.cache;
  out.seed = base.settings.embedding.seed;
  return out;
}

/// The light that gathered pictures read: what it was before where that is enough or still right.
void find_records(const SessionState::Parts* before, const Wanted& wanted,
                  SessionState::Parts* parts, EditReport* report) {
  const SessionBase& base = *parts->base;
  if (!parts->answered_by) return;
  const Method by = *parts->answered_by;
  const bool by_network = by == Method::Network;
  const bool has = before != nullptr && before->records && before->records->filled_by == by;
  if (has && before->records->fit(*parts->edits, by)) {
    parts->records = before->records;
  } else if (has && (by_network ? parts->accuracy : wanted.least) == Accuracy::Kept) {
    parts->records = before->records;
    parts->accuracy = Accuracy::Kept;
  } else {
    if (wanted.check) wanted.check();
    const Traced at_gain_1 = is_scaled(*parts->edits)
                                 ? trace(base, *parts->edits, /*lit=*/false, report)
                                 : Traced{parts->scene, parts->bvh, parts->lights};
    const Timer timer;
    parts->records = std::make_shared<const LightRecords>(trace_light_records(
        *at_gain_1.bvh, *at_gain_1.lights, parts->edits, by, cache_settings(base), wanted.check));
    report->light_ms += 1e3 * timer.seconds();
  }
  const bool same = before != nullptr && before->cache && before->records == parts->records &&
                    same_answers(*before, *parts) && same_scene(*before->edits, *parts->edits);
  parts->cache = same ? before->cache : parts->make_cache();
}

}  // namespace

int64_t scene_bytes(const scene::Scene& scene) {
  size_t bytes = 0;
  for (const scene::Mesh& mesh : scene.meshes) {
    bytes += mesh.positions.size() * sizeof(Vec3) +
             mesh.triangles.size() * sizeof(mesh.triangles[0]) + mesh.colors.size() * sizeof(Rgb);
    for (const std::vector<Vec2>& uvs : mesh.uvs) bytes += uvs.size() * sizeof(Vec2);
  }
  return static_cast<int64_t>(bytes);
}

Traced trace(const SessionBase& base, const SceneEdits& edits, bool lit, EditReport* report) {
  Traced out;
  Timer timer;
  out.scene = std::make_shared<const scene::Scene>(make_scene(base.scene, edits, lit));
  report->scene_ms += 1e3 * timer.seconds();
  timer.restart();
  out.bvh = std::make_shared<const pathtrace::Bvh>(*out.scene, *base.trees, tree_of_mesh(edits));
  report->bvh_ms += 1e3 * timer.seconds();
  timer.restart();
  out.lights = std::make_shared<const pathtrace::Lights>(*out.scene);
  report->scene_ms += 1e3 * timer.seconds();
  return out;
}

SessionBase::SessionBase(scene::Scene first, std::optional<runtime::Network> with,
                         SessionSettings how)
    : scene(std::move(first)),
      trees(pathtrace::Bvh::with_own_meshes(scene)),
      network(std::move(with)),
      settings(std::move(how)) {
  if (settings.pictures != Method::Path) denoiser->prepare(image::OidnQuality::Fast);
}

std::unique_ptr<SessionState::Parts> make_parts(std::shared_ptr<const SessionBase> base,
                                                std::shared_ptr<const SceneEdits> edits,
                                                const SessionState::Parts* before,
                                                const Wanted& wanted, EditReport* report) {
  auto parts = std::make_unique<SessionState::Parts>();
  parts->base = std::move(base);
  parts->edits = std::move(edits);
  const SceneEdits& now = *parts->edits;
  const bool refines = before != nullptr && before->edits == parts->edits;
  const Traced shown = refines ? Traced{before->scene, before->bvh, before->lights}
                               : trace(*parts->base, now, /*lit=*/true, report);
  parts->scene = shown.scene;
  parts->bvh = shown.bvh;
  parts->lights = shown.lights;
  report->bvh_rebuilt = before == nullptr || !same_geometry(*before->edits, now);
  parts->cameras = wanted.cameras      ? without_repeats(*wanted.cameras)
                   : before != nullptr ? before->cameras
                                       : without_repeats(parts->base->settings.cameras);
  const SessionBase& all = *parts->base;
  const Method pictures = all.settings.pictures;
  if (pictures == Method::Gather) parts->answered_by = Method::Gather;
  if (pictures != Method::Gather && all.network) {
    Lighting(before, wanted, parts.get(), report).run();
    if (pictures == Method::Network)
      parts->answered_by = parts->asks_network ? Method::Network : Method::Gather;
  }
  find_records(before, wanted, parts.get(), report);
  const bool same = wanted.cameras && refines && same_answers(*before, *parts);
  parts->version = (before != nullptr ? before->version : 0) + (same ? 0 : 1);
  report->version = parts->version;
  report->layers = static_cast<int>(parts->layers.size());
  report->accuracy = parts->accuracy;
  return parts;
}

std::shared_ptr<LazyCache> SessionState::Parts::make_cache() const {
  // The BVH and the lights borrow the scene, and the cache may outlive this state.
  if (answered_by == Method::Gather) {
    return std::make_shared<LazyCache>([from = records, now = edits, held = scene, rays = bvh] {
      return gi::IrradianceCache::of(from->geometry(*now, *rays), from->traced.places,
                                     from->light(*now));
    });
  }
  return std::make_shared<LazyCache>([from = records, now = edits, by = layers, held = scene,
                                      rays = bvh, lit = lights, settings = cache_settings(*base)] {
    const auto asked = [&](std::span<const Vec3> positions, std::span<const Vec3> normals,
                           std::span<const Rgb> albedos) {
      return sum_of(by, {positions, normals, albedos});
    };
    return render::make_cache({*rays, *lit}, settings, from->geometry(*now, *rays),
                              from->traced.places, from->light(*now), asked);
  });
}

std::vector<Rgb> SessionState::Parts::answer(const runtime::QueryPoints& queries) const {
  return sum_of(layers, queries);
}

}  // namespace lte::infer
