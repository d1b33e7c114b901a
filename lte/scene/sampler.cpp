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
#include "lte/scene/shading_normal.h"
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

Vec3 bent_normal(const Scene& scene, int instance, uint32_t triangle, const Vec2& uv,
                 const Vec3& front) {
  if (!has_normal_map(scene, scene.instances[static_cast<size_t>(instance)])) return front;
  return shading_normal(scene, instance, triangle, uv.x, uv.y, 0, front);
}

bool has_normal_map(const Scene& scene) {
  return std::any_of(scene.instances.begin(), scene.instances.end(),
                     [&](const Instance& each) { return has_normal_map(scene, each); });
}

struct Drawn {
  SurfaceSamples samples;
  std::vector<uint8_t> back;  ///< 1 for points on the back of a surface
  double area = 0;            ///< of the faces
};

/// Fills `count` points from `begin` on with one point of each of `count` equal strata of the
/// table's area.
void fill(const Scene& scene, const AreaTable& table, int64_t begin, int64_t count,
          const SamplerOptions& options, Drawn* drawn) {
  SurfaceSamples* samples = &drawn->samples;
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
          evaluate_surface(scene, place.face.instance, place.triangle, uv.x, uv.y, footprint);
      samples->position[at] = surface.position;
      samples->normal[at] = place.face.back ? -surface.normal : surface.normal;
      drawn->back[at] = place.face.back ? 1 : 0;
      samples->albedo[at] = surface.albedo;
      samples->emission[at] = surface.emission;
      samples->gloss[at] = surface.gloss;
      samples->area[at] = area;
      samples->light_group[at] = surface.light_group;
      if (samples->shading_normal.empty()) continue;
      const Vec3 bent = bent_normal(scene, place.face.instance, place.triangle, uv, surface.normal);
      samples->shading_normal[at] = place.face.back ? -bent : bent;
    }
  });
}

struct Split {
  std::vector<Face> emissive, other;
};

const Material& material_of(const Scene& scene, const Instance& instance) {
  return scene.materials[scene.meshes[instance.mesh].material];
}

/// The faces but those of the luminaires `without`, by light group.
Split split_faces(const Scene& scene, const std::set<int>& without) {
  std::vector<int> emissive, other;
  for (size_t i = 0; i < scene.instances.size(); ++i) {
    const Instance& instance = scene.instances[i];
    const bool emits = material_of(scene, instance).emissive();
    if (emits && without.contains(instance.light_group)) continue;
    (emits ? emissive : other).push_back(static_cast<int>(i));
  }
  return {emitting_faces(scene, emissive), fronts(other)};
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

Drawn make_drawn(int64_t count, double area, bool shading_normals) {
  const auto n = static_cast<size_t>(count);
  Drawn drawn{{}, std::vector<uint8_t>(n), area};
  SurfaceSamples& out = drawn.samples;
  out.position.resize(n);
  out.normal.resize(n);
  out.albedo.resize(n);
  out.emission.resize(n);
  out.gloss.resize(n);
  out.area.resize(n);
  out.light_group.resize(n, kNone);
  if (shading_normals) out.shading_normal.resize(n);
  return drawn;
}

/// The faces of a light group's emissive instances.
struct Luminaire {
  std::vector<Face> front, back;  ///< none where it does not emit from the back

  int64_t sides() const { return back.empty() ? 1 : 2; }
};

/// Those that have area, by light group.
using Luminaires = std::map<int, Luminaire>;

Luminaires find_luminaires(const Scene& scene) {
  Luminaires found;
  for (size_t i = 0; i < scene.instances.size(); ++i) {
    const Instance& instance = scene.instances[i];
    if (!material_of(scene, instance).emissive()) continue;
    Luminaire& luminaire = found[instance.light_group];
    const auto index = static_cast<int>(i);
    for (const Face& face : emitting_faces(scene, std::span(&index, 1))) {
      if (AreaTable(scene, {face}).total() > 0)
        (face.back ? luminaire.back : luminaire.front).push_back(face);
    }
  }
  std::erase_if(found, [](const auto& entry) { return entry.second.front.empty(); });
  return found;
}

/// How many points luminaires take that have one a face.
int64_t points_alone(const Luminaires& luminaires, const std::set<int>& alone) {
  int64_t points = 0;
  for (const int group : alone) points += luminaires.at(group).sides();
  return points;
}

Drawn draw_by_area(const Scene& scene, int64_t count, const RepeatedTriangles& repeated,
                   const SamplerOptions& options) {
  const AreaTable all(scene, fronts(all_instances(scene)), &repeated);
  check_area(scene, all.total());
  Drawn out = make_drawn(count, all.total(), options.shading_normals);
  fill(scene, all, 0, count, options, &out);
  return out;
}

/// Each of the luminaires `alone` gets one point a face that stands for all of it. The others share
/// the rest by area, with emissive_share of all points for luminaires.
Drawn draw_with_share(const Scene& scene, int64_t count, const Luminaires& luminaires,
                      const std::set<int>& alone, const RepeatedTriangles& repeated,
                      const SamplerOptions& options) {
  const Split split = split_faces(scene, alone);
  const AreaTable emissive(scene, split.emissive), other(scene, split.other, &repeated);
  const double shared = emissive.total() + other.total();
  Drawn out = make_drawn(count, shared, options.shading_normals);
  const int64_t single = points_alone(luminaires, alone);
  const int64_t strata = count - single;
  int64_t next = strata;
  for (const int group : alone) {
    const Luminaire& luminaire = luminaires.at(group);
    for (const std::vector<Face>& faces : {luminaire.front, luminaire.back}) {
      if (faces.empty()) continue;
      const AreaTable table(scene, faces);
      fill(scene, table, next++, 1, options, &out);
      out.area += table.total();
    }
  }
  check_area(scene, out.area);
  const double by_area = static_cast<double>(strata) * emissive.total() / shared;
  const double wanted =
      std::ceil(static_cast<double>(count) * options.emissive_share) - static_cast<double>(single);
  if (emissive.total() > 0 && other.total() > 0 && strata >= 2 && wanted > by_area) {
    const int64_t lit = std::min(static_cast<int64_t>(wanted), strata - 1);
    fill(scene, other, 0, strata - lit, options, &out);
    fill(scene, emissive, strata - lit, lit, options, &out);
  } else {
    std::vector<Face> both = split.emissive;
    both.insert(both.end(), split.other.begin(), split.other.end());
    std::sort(both.begin(), both.end());
    fill(scene, AreaTable(scene, both, &repeated), 0, strata, options, &out);
  }
  return out;
}

/// Misses no luminaire: one of which no stratum met a face, being small beside others, gets a point
/// a face. Only where that would take more than half of the points does chance decide.
Drawn draw_with_all_luminaires(const Scene& scene, int64_t count, const RepeatedTriangles& repeated,
                               const SamplerOptions& options) {
  const Luminaires luminaires = find_luminaires(scene);
  std::set<int> alone;
  for (;;) {
    Drawn drawn = draw_with_share(scene, count, luminaires, alone, repeated, options);
    std::set<std::pair<int, bool>> met;
    for (size_t i = 0; i < drawn.back.size(); ++i)
      met.emplace(drawn.samples.light_group[i], drawn.back[i] != 0);
    std::set<int> more = alone;
    for (const auto& [group, luminaire] : luminaires) {
      if (!met.contains({group, false}) ||
          (!luminaire.back.empty() && !met.contains({group, true})))
        more.insert(group);
    }
    if (more.size() == alone.size() || 2 * points_alone(luminaires, more) > count) return drawn;
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
  if (!shading_normal.empty()) reduce(&shading_normal);
}

SurfaceSamples sample_surface(const Scene& scene, int64_t count, const SamplerOptions& wanted) {
  SamplerOptions options = wanted;
  options.shading_normals = wanted.shading_normals && has_normal_map(scene);
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

double surface_area(const Scene& scene) {
  return AreaTable(scene, fronts(all_instances(scene))).total();
}

}  // namespace lte::scene
