#include "lte/scene/sampler.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include "lte/base/check.h"
#include "lte/base/parallel.h"
#include "lte/base/random.h"
#include "lte/scene/area_table.h"
#include "lte/scene/light_points.h"
#include "lte/scene/surface.h"

namespace lte::scene {
namespace {

constexpr int64_t kGrain = 2048;

/// Barycentric coordinates of the place that a fraction of a triangle's area names, along a curve
/// that visits quarter after quarter (Basu and Owen 2015). It preserves area and keeps what is near
/// in the fraction near in the triangle: strata in one dimension become strata on the surface.
Vec2 triangle_point(double fraction) {
  constexpr int kLevels = 24;
  auto digits = static_cast<uint64_t>(std::ldexp(fraction, 2 * kLevels));
  Vec2 a{0, 0}, b{1, 0}, c{0, 1};
  const auto middle = [](const Vec2& p, const Vec2& q) {
    return Vec2{(p.x + q.x) / 2, (p.y + q.y) / 2};
  };
  for (int level = kLevels - 1; level >= 0; --level) {
    const Vec2 ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    switch ((digits >> (2 * level)) & 3) {
      case 0:
        a = bc;
        b = ca;
        c = ab;
        break;
      case 1:
        b = ab;
        c = ca;
        break;
      case 2:
        a = ab;
        c = bc;
        break;
      default:
        a = ca;
        b = bc;
        break;
    }
  }
  return {(a.x + b.x + c.x) / 3, (a.y + b.y + c.y) / 3};
}

/// Fills `count` points from `begin` on with one point of each of `count` equal strata of the
/// table's area.
void fill(const Scene& scene, const AreaTable& table, int64_t begin, int64_t count,
          const SamplerOptions& options, SurfaceSamples* samples) {
  const double stratum = table.total() / static_cast<double>(count);
  const auto area = static_cast<float>(stratum);
  const float footprint = options.filter_footprint ? std::sqrt(area) : 0.0f;
  parallel_for(count, kGrain, [&](int64_t low, int64_t high) {
    for (int64_t i = low; i < high; ++i) {
      const auto at = static_cast<size_t>(begin + i);
      Rng rng(options.seed, static_cast<uint64_t>(at));
      const double variate = static_cast<double>(rng.next_u64() >> 11) * 0x1p-53;
      const AreaTable::Place place = table.locate((static_cast<double>(i) + variate) * stratum);
      const Vec2 uv = triangle_point(place.fraction);
      const Surface surface =
          evaluate_surface(scene, place.instance, place.triangle, uv.x, uv.y, footprint);
      samples->position[at] = surface.position;
      samples->normal[at] = surface.normal;
      samples->albedo[at] = surface.albedo;
      samples->emission[at] = surface.emission;
      samples->gloss[at] = surface.gloss;
      samples->area[at] = area;
      samples->light_group[at] = surface.light_group;
    }
  });
}

struct Split {
  std::vector<int> emissive, other;
};

const Material& material_of(const Scene& scene, const Instance& instance) {
  return scene.materials[scene.meshes[instance.mesh].material];
}

/// The instances but those of the luminaires `without`, by light group.
Split split_instances(const Scene& scene, const std::set<int>& without) {
  Split out;
  for (size_t i = 0; i < scene.instances.size(); ++i) {
    const Instance& instance = scene.instances[i];
    const bool emits = material_of(scene, instance).emissive();
    if (emits && without.contains(instance.light_group)) continue;
    (emits ? out.emissive : out.other).push_back(static_cast<int>(i));
  }
  return out;
}

std::vector<int> all_instances(const Scene& scene) {
  std::vector<int> all(scene.instances.size());
  std::iota(all.begin(), all.end(), 0);
  return all;
}

void check_area(const Scene& scene, double area) {
  LTE_CHECK(std::isfinite(area), "scene ", scene.name, ": its surface area is not finite");
  LTE_CHECK(area > 0, "scene ", scene.name, ": no surface has area, nothing to sample");
}

SurfaceSamples make_samples(int64_t count) {
  const auto n = static_cast<size_t>(count);
  SurfaceSamples out;
  out.position.resize(n);
  out.normal.resize(n);
  out.albedo.resize(n);
  out.emission.resize(n);
  out.gloss.resize(n);
  out.area.resize(n);
  out.light_group.resize(n, kNone);
  return out;
}

/// The emissive instances of each light group that have area.
using Luminaires = std::map<int, std::vector<int>>;

Luminaires find_luminaires(const Scene& scene) {
  Luminaires found;
  for (size_t i = 0; i < scene.instances.size(); ++i) {
    if (material_of(scene, scene.instances[i]).emissive())
      found[scene.instances[i].light_group].push_back(static_cast<int>(i));
  }
  std::erase_if(found,
                [&](const auto& entry) { return !(AreaTable(scene, entry.second).total() > 0); });
  return found;
}

struct Drawn {
  SurfaceSamples samples;
  double area = 0;  ///< of the surfaces
};

Drawn draw_by_area(const Scene& scene, int64_t count, const RepeatedTriangles& repeated,
                   const SamplerOptions& options) {
  const AreaTable all(scene, all_instances(scene), &repeated);
  check_area(scene, all.total());
  Drawn out{make_samples(count), all.total()};
  fill(scene, all, 0, count, options, &out.samples);
  return out;
}

/// Each of the luminaires `alone` gets one point that stands for all of it. The others share the
/// rest by area, with emissive_share of all points for luminaires.
Drawn draw_with_share(const Scene& scene, int64_t count, const Luminaires& luminaires,
                      const std::set<int>& alone, const RepeatedTriangles& repeated,
                      const SamplerOptions& options) {
  const Split split = split_instances(scene, alone);
  const AreaTable emissive(scene, split.emissive), other(scene, split.other, &repeated);
  const double shared = emissive.total() + other.total();
  Drawn out{make_samples(count), shared};
  const auto strata = count - static_cast<int64_t>(alone.size());
  int64_t next = strata;
  for (const int group : alone) {
    const AreaTable table(scene, luminaires.at(group));
    fill(scene, table, next++, 1, options, &out.samples);
    out.area += table.total();
  }
  check_area(scene, out.area);
  const double by_area = static_cast<double>(strata) * emissive.total() / shared;
  const double wanted = std::ceil(static_cast<double>(count) * options.emissive_share) -
                        static_cast<double>(alone.size());
  if (emissive.total() > 0 && other.total() > 0 && strata >= 2 && wanted > by_area) {
    const int64_t lit = std::min(static_cast<int64_t>(wanted), strata - 1);
    fill(scene, other, 0, strata - lit, options, &out.samples);
    fill(scene, emissive, strata - lit, lit, options, &out.samples);
  } else {
    std::vector<int> both = split.emissive;
    both.insert(both.end(), split.other.begin(), split.other.end());
    std::sort(both.begin(), both.end());
    fill(scene, AreaTable(scene, both, &repeated), 0, strata, options, &out.samples);
  }
  return out;
}

/// Misses no luminaire: what no stratum met, being small beside others, gets a point of its own.
/// Only where that would take more than half of the points does chance decide.
Drawn draw_with_all_luminaires(const Scene& scene, int64_t count, const RepeatedTriangles& repeated,
                               const SamplerOptions& options) {
  const Luminaires luminaires = find_luminaires(scene);
  std::set<int> alone;
  for (;;) {
    Drawn drawn = draw_with_share(scene, count, luminaires, alone, repeated, options);
    const std::vector<int>& groups = drawn.samples.light_group;
    const std::set<int> met(groups.begin(), groups.end());
    std::set<int> more = alone;
    for (const auto& [group, instances] : luminaires)
      if (!met.contains(group)) more.insert(group);
    if (more.size() == alone.size() || 2 * static_cast<int64_t>(more.size()) > count) return drawn;
    alone = std::move(more);
  }
}

}  // namespace

void SurfaceSamples::keep(const std::vector<size_t>& rows) {
  const auto reduce = [&](auto* values) {
    for (size_t i = 0; i < rows.size(); ++i) (*values)[i] = (*values)[rows[i]];
    values->resize(rows.size());
  };
  reduce(&position);
  reduce(&normal);
  reduce(&albedo);
  reduce(&emission);
  reduce(&gloss);
  reduce(&area);
  reduce(&light_group);
}

SurfaceSamples sample_surface(const Scene& scene, int64_t count, const SamplerOptions& options) {
  LTE_CHECK(count >= 1, "sample_surface: at least 1 point is needed, got ", count);
  LTE_CHECK(options.emissive_share >= 0 && options.emissive_share < 1,
            "sample_surface: emissive_share must be in [0, 1), got ", options.emissive_share);
  LTE_CHECK(options.environment_share >= 0 && options.environment_share < 1,
            "sample_surface: environment_share must be in [0, 1), got ", options.environment_share);
  const int64_t surface = surface_point_count(scene, count, options);
  const RepeatedTriangles repeated(scene);
  Drawn drawn = options.emissive_share > 0
                    ? draw_with_all_luminaires(scene, surface, repeated, options)
                    : draw_by_area(scene, surface, repeated, options);
  const int64_t local = light_point_counts(scene, count, options).local;
  const auto area = static_cast<float>(drawn.area / static_cast<double>(surface + local));
  append_light_points(scene, count, area, options, &drawn.samples);
  return std::move(drawn.samples);
}

int64_t surface_point_count(const Scene& scene, int64_t count, const SamplerOptions& options) {
  const LightPointCounts lights = light_point_counts(scene, count, options);
  const int64_t surface = count - lights.total();
  LTE_CHECK(surface >= 1, "sample_surface: ", count, " points cannot hold ",
            lights.local + lights.suns, " punctual lights, ", lights.environment,
            " points of the environment, and the surfaces of scene ", scene.name,
            "; ask for more points");
  return surface;
}

double surface_area(const Scene& scene) { return AreaTable(scene, all_instances(scene)).total(); }

}  // namespace lte::scene
