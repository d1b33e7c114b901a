#include "lte/bake/rebake.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "lte/bake/rates.h"
#include "lte/bake/sides.h"
#include "lte/bake/texel_sampler.h"
#include "lte/base/check.h"
#include "lte/base/random.h"

namespace lte::bake {
namespace {

constexpr uint64_t kChangePaths = 87, kAgainRays = 88, kAgainPaths = 89;
/// One texel of so many is looked at, by two passes of so many paths and light samples.
constexpr uint64_t kLookedAt = 8;
constexpr int kChangeRays = 8;
/// Rounds of means over neighbours, of changes; one over the sum of a texel's squared weights.
constexpr int kChangeRounds = 10;
constexpr float kChangeTexels = 4 * kPi * kChangeRounds * 2 / 3;
/// Of the mean light: what is darker counts like that, as where errors are compared.
constexpr double kDarkChange = 0.1;
/// Rings of neighbours around a change that are baked anew too, and that smoothing reads.
constexpr int kDilatedRings = 2, kSmoothingRings = 16;

std::vector<int32_t> find_old_texels(const Relayout& relayout, const OldLight& old) {
  const Atlas& atlas = relayout.layout.atlas;
  const Texels& texels = relayout.layout.texels;
  std::vector<int32_t> at(static_cast<size_t>(atlas.width) * static_cast<size_t>(atlas.height),
                          kNew);
  for (size_t i = 0; i < old.pixel.size(); ++i)
    at[static_cast<size_t>(old.pixel[i])] = static_cast<int32_t>(i);
  std::vector<int32_t> out(texels.size(), kNew);
  for (size_t i = 0; i < texels.size(); ++i) {
    const auto instance = static_cast<size_t>(texels.fragments[texels.first[i]].instance);
    const int32_t there = at[texels.pixel[i]];
    if (there == kNew || relayout.moved[instance] != 0) continue;
    if (old.instance[static_cast<size_t>(there)] == relayout.old_instance[instance]) out[i] = there;
  }
  return out;
}

void add_rings(const TexelGraph& graph, int rings, std::vector<uint8_t>* marked) {
  std::vector<uint32_t> border;
  for (uint32_t i = 0; i < marked->size(); ++i)
    if ((*marked)[i] != 0) border.push_back(i);
  for (int ring = 0; ring < rings; ++ring) {
    std::vector<uint32_t> next;
    for (const uint32_t i : border) {
      for (const uint32_t j : graph.neighbours(i)) {
        if ((*marked)[j] != 0) continue;
        (*marked)[j] = 1;
        next.push_back(j);
      }
    }
    border = std::move(next);
  }
}

/// Sides of charts: the old ones where an old texel says so, else by `chosen`.
std::vector<uint8_t> old_sides(const Layout& layout, const OldLight& old, const Kept& kept,
                               std::vector<uint8_t> chosen) {
  for (size_t i = 0; i < kept.old_texel.size(); ++i) {
    if (kept.old_texel[i] == kNew) continue;
    const int32_t chart = old.chart[static_cast<size_t>(kept.old_texel[i])];
    chosen[static_cast<size_t>(layout.texels.chart[i])] =
        old.state.back[static_cast<size_t>(chart)];
  }
  return chosen;
}

/// Changes of some texels' light, and the light, over two passes.
struct Changes {
  std::vector<Rgb> mean, square, light;
  std::vector<float> weight;
  explicit Changes(size_t count) : mean(count), square(count), light(count), weight(count) {}
};

Changes trace_changes(const render::TracedScene& before, const render::TracedScene& now,
                      const Layout& layout, std::span<const uint32_t> which,
                      const std::vector<uint8_t>& back, const LightOptions& options) {
  LightOptions few = options;
  few.rays = kChangeRays;
  const TexelSampler sampler(layout.atlas, layout.texels, few);
  render::PointSampling sampling = sampler.sampling(kChangePaths);
  TexelSamples was(layout.texels.size(), options.direct), is = was;
  const auto path_before = render::make_path(before, options.max_depth);
  const auto path_now = render::make_path(now, options.max_depth);
  for (int k = 0; k < 2; ++k) {
    sampler.pass(*path_before, which, back, sampling, k, &was);
    sampler.pass(*path_now, which, back, sampling, k, &is);
  }
  Changes out(layout.texels.size());
  for (const uint32_t i : which) {
    const Rgb light = is.sum(i) * 0.5f, change = light - was.sum(i) * 0.5f;
    out.mean[i] = change;
    out.square[i] = change * change;
    out.light[i] = light;
    out.weight[i] = 1;
  }
  return out;
}

/// Whether a texel's light is another one, or may be.
std::vector<uint8_t> mark(const TexelGraph& graph, Changes changes, double tolerance) {
  const size_t count = graph.size();
  double sum = 0, texels = 0;
  for (size_t i = 0; i < count; ++i) {
    sum += double{luminance(changes.light[i])};
    texels += double{changes.weight[i]};
  }
  const auto dark = static_cast<float>(kDarkChange * sum / std::max(1.0, texels));
  const std::vector<Rgb> mean = graph.spread(std::move(changes.mean), kChangeRounds);
  const std::vector<Rgb> square = graph.spread(std::move(changes.square), kChangeRounds);
  const std::vector<Rgb> light = graph.spread(std::move(changes.light), kChangeRounds);
  const std::vector<float> weight = graph.spread(std::move(changes.weight), kChangeRounds);
  std::vector<uint8_t> out(count);
  for (size_t i = 0; i < count; ++i) {
    const float w = weight[i];
    const float looked_at = std::max(1.0f, kChangeTexels * w);
    const float bound = static_cast<float>(tolerance) * (luminance(light[i]) / w + dark);
    for (int c = 0; c < 3 && w > 0; ++c) {
      const float change = std::abs(mean[i][c] / w);
      const float spread = std::sqrt(square[i][c] / w / looked_at);
      if (change + spread > bound) out[i] = 1;
    }
    if (!(w > 0)) out[i] = 1;  // nobody has looked there
  }
  return out;
}

std::vector<uint32_t> all_changed(const Kept& kept) {
  std::vector<uint32_t> out;
  for (uint32_t i = 0; i < kept.changed.size(); ++i)
    if (kept.changed[i] != 0) out.push_back(i);
  return out;
}

void put(const TexelSamples& from, size_t there, size_t here, TexelSamples* to) {
  for (size_t h = 0; h < 2; ++h) {
    to->indirect[h][here] = from.indirect[h][there];
    if (!to->direct[h].empty()) to->direct[h][here] = from.direct[h][there];
  }
}

/// Old samples at their texels of the new atlas.
LightState moved_over(const Layout& layout, const OldLight& old, const Kept& kept,
                      const LightOptions& options) {
  const size_t count = layout.texels.size();
  LightState out;
  out.samples = TexelSamples(count, options.direct);
  out.paths = TexelSamples(count, false);
  out.samples.passes = old.state.samples.passes;
  out.paths.passes = old.state.paths.passes;
  out.two_sided = old.state.two_sided;
  out.dark.assign(count, 0);
  out.rate.assign(count, kFullRate);
  for (size_t i = 0; i < count; ++i) {
    if (kept.old_texel[i] == kNew) continue;
    const auto there = static_cast<size_t>(kept.old_texel[i]);
    // Dark ones had none: light may have been let in.
    if (old.state.rate[there] != 0) out.rate[i] = old.state.rate[there];
    if (kept.changed[i] != 0) continue;
    out.dark[i] = old.state.dark[there];
    put(old.state.samples, there, i, &out.samples);
    put(old.state.paths, there, i, &out.paths);
  }
  return out;
}

}  // namespace

Kept find_changes(const render::TracedScene& before, const render::TracedScene& now,
                  const Relayout& relayout, const OldLight& old, const LightOptions& options,
                  const RebakeOptions& rebake) {
  const Layout& layout = relayout.layout;
  const Texels& texels = layout.texels;
  Kept out;
  out.old_texel = find_old_texels(relayout, old);
  const std::vector<uint8_t> back =
      old_sides(layout, old, out, std::vector<uint8_t>(static_cast<size_t>(layout.atlas.charts)));
  const std::vector<Vec3> normals = turned_normals(texels, back);
  const std::vector<uint8_t> none(texels.size());
  const TexelGraph graph(now.bvh, {texels.position, normals, texels.edge, none});
  std::vector<uint32_t> which;
  for (uint32_t i = 0; i < texels.size(); ++i) {
    // Narrow things have few texels.
    const bool few = graph.neighbours(i).size() < 3;
    if (out.old_texel[i] != kNew &&
        (few || hash_combine(options.seed + kChangePaths, texels.pixel[i]) % kLookedAt == 0))
      which.push_back(i);
  }
  out.changed =
      mark(graph, trace_changes(before, now, layout, which, back, options), rebake.tolerance);
  for (size_t i = 0; i < texels.size(); ++i)
    if (out.old_texel[i] == kNew) out.changed[i] = 1;
  add_rings(graph, kDilatedRings, &out.changed);
  out.near = out.changed;
  add_rings(graph, kSmoothingRings, &out.near);
  return out;
}

LightState rebake(const render::TracedScene& scene, const render::Integrator& integrator,
                  const Layout& layout, const LightOptions& options, const OldLight& old,
                  const Kept& kept) {
  const Atlas& atlas = layout.atlas;
  const Texels& texels = layout.texels;
  LightState out = moved_over(layout, old, kept, options);
  std::vector<uint32_t> which = all_changed(kept);
  const TexelSampler sampler(atlas, texels, options);
  TexelSamples fresh(texels.size(), options.direct), paths(texels.size(), false);
  const std::vector<uint8_t> front(static_cast<size_t>(atlas.charts));
  out.back = old_sides(layout, old, kept, front);
  for (int k = 0; k < 2; ++k)
    sampler.pass(integrator, which, out.back, sampler.sampling(kAgainRays), k, &fresh);
  const std::vector<uint8_t> before = out.back;
  out.back = old_sides(layout, old, kept,
                       choose_sides(sampler, integrator, atlas, texels, which, fresh).back);
  std::vector<uint32_t> turned = which;
  std::erase_if(turned, [&](uint32_t i) {
    const auto chart = static_cast<size_t>(texels.chart[i]);
    return out.back[chart] == before[chart];
  });
  const TexelSamples nothing(1, options.direct);
  for (const uint32_t i : turned) put(nothing, 0, i, &fresh);
  fresh.passes = {};
  for (int k = 0; k < 2; ++k)
    sampler.pass(integrator, turned, out.back, sampler.sampling(kAgainRays), k, &fresh);
  for (const uint32_t i : which) put(fresh, i, i, &out.samples);
  const std::vector<uint8_t> dark = out.dark;
  find_darkness(scene.bvh, atlas, texels, options, &out);
  for (size_t i = 0; i < dark.size(); ++i)
    if (kept.changed[i] == 0) out.dark[i] = dark[i];
  std::erase_if(which, [&](uint32_t i) { return out.dark[i] != 0; });
  const auto sum = [](const std::array<int, 2>& passes) { return passes[0] + passes[1]; };
  for (int k = 2; k < sum(out.samples.passes); ++k)
    sampler.pass(integrator, which, out.back, sampler.sampling(kAgainRays), k, &fresh, out.rate);
  if (sum(out.paths.passes) > 0) {
    LightOptions thin = options;
    thin.rays = kPathsAPass;
    thin.direct = false;
    const auto by_paths = render::make_path(scene, options.max_depth);
    const TexelSampler thin_sampler(atlas, texels, thin);
    for (int k = 0; k < sum(out.paths.passes); ++k)
      thin_sampler.pass(*by_paths, which, out.back, thin_sampler.sampling(kAgainPaths), k, &paths,
                        out.rate);
  }
  for (const uint32_t i : which) {
    put(fresh, i, i, &out.samples);
    put(paths, i, i, &out.paths);
  }
  return out;
}

TexelLight rebaked_light(const pathtrace::Bvh& bvh, render::Method method, const Layout& layout,
                         const LightOptions& options, LightState state, const OldLight& old,
                         const Kept& kept) {
  const Texels& texels = layout.texels;
  const std::vector<Vec3> normals = turned_normals(texels, state.back);
  std::vector<uint8_t> skipped = state.dark;
  for (size_t i = 0; i < skipped.size(); ++i) skipped[i] |= kept.near[i] != 0 ? 0 : 1;
  state.graph = std::make_shared<const TexelGraph>(
      bvh, GraphPlaces{texels.position, normals, texels.edge, skipped});
  TexelLight out = light_of(bvh, method, layout.atlas, texels, options, std::move(state));
  for (size_t i = 0; i < texels.size(); ++i) {
    if (kept.changed[i] != 0) continue;
    const size_t pixel = texels.pixel[i];
    out.irradiance[i] = {old.picture[3 * pixel], old.picture[3 * pixel + 1],
                         old.picture[3 * pixel + 2]};
  }
  return out;
}

void restore_kept(const Layout& layout, const OldLight& old, const Kept& kept, Lightmap* map) {
  std::vector<uint8_t> fresh(map->pixels()), texel(map->pixels());
  for (size_t i = 0; i < layout.texels.size(); ++i) {
    const size_t pixel = layout.texels.pixel[i];
    texel[pixel] = 1;
    if (kept.changed[i] == 0) continue;
    fresh[pixel] = 1;
    const int x = static_cast<int>(pixel) % map->width, y = static_cast<int>(pixel) / map->width;
    const int first = std::max(0, x - kDilation), last = std::min(map->width - 1, x + kDilation);
    for (int py = std::max(0, y - kDilation); py <= std::min(map->height - 1, y + kDilation);
         ++py) {
      uint8_t* row = &fresh[static_cast<size_t>(py) * static_cast<size_t>(map->width)];
      for (int px = first; px <= last; ++px) row[px] |= 2;
    }
  }
  const auto filled = static_cast<uint8_t>(Texel::Filled);
  for (size_t pixel = 0; pixel < fresh.size(); ++pixel) {
    const bool kept_texel = texel[pixel] != 0 && (fresh[pixel] & 1) == 0;
    const bool kept_space = texel[pixel] == 0 && fresh[pixel] == 0 && map->mask[pixel] == filled &&
                            old.mask[pixel] == filled;
    if (!kept_texel && !kept_space) continue;
    map->mask[pixel] = old.mask[pixel];
    for (size_t c = 0; c < 3; ++c)
      map->layers[0].irradiance[3 * pixel + c] = old.picture[3 * pixel + c];
  }
}

}  // namespace lte::bake
