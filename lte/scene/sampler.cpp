#include "lte/scene/sampler.h"

#include <cmath>
#include <numeric>

#include "lte/base/check.h"
#include "lte/base/parallel.h"
#include "lte/base/random.h"
#include "lte/scene/area_table.h"
#include "lte/scene/environment_points.h"
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

/// The power of a light in W. A spot's falloff is that of KHR_lights_punctual, the square of a ramp
/// in the cosine, which has a closed integral.
Rgb power(const PunctualLight& light) {
  if (light.kind == LightKind::Point) return light.intensity * (4 * kPi);
  const float inner = std::cos(light.inner_cone), outer = std::cos(light.outer_cone);
  return light.intensity * (2 * kPi * ((1 - inner) + (inner - outer) / 3));
}

std::vector<const PunctualLight*> local_lights(const Scene& scene, const SamplerOptions& options) {
  std::vector<const PunctualLight*> out;
  if (!options.punctual_lights) return out;
  for (const PunctualLight& light : scene.lights) {
    // A directional light has no place; it enters as direct light only.
    if (light.kind != LightKind::Directional) out.push_back(&light);
  }
  return out;
}

void fill_lights(const std::vector<const PunctualLight*>& lights, float area, int64_t begin,
                 SurfaceSamples* samples) {
  for (size_t i = 0; i < lights.size(); ++i) {
    const size_t at = static_cast<size_t>(begin) + i;
    samples->position[at] = lights[i]->position;
    // A point light has no side; straight down is as good as any, and the same for all.
    samples->normal[at] =
        lights[i]->kind == LightKind::Spot ? lights[i]->direction : Vec3{0, -1, 0};
    samples->albedo[at] = {0, 0, 0};
    samples->emission[at] = power(*lights[i]) / (kPi * area);
    samples->area[at] = area;
    samples->light_group[at] = lights[i]->light_group;
  }
}

struct Split {
  std::vector<int> emissive, other;
};

Split split_instances(const Scene& scene) {
  Split out;
  for (size_t i = 0; i < scene.instances.size(); ++i) {
    const Material& material = scene.materials[scene.meshes[scene.instances[i].mesh].material];
    (material.emissive() ? out.emissive : out.other).push_back(static_cast<int>(i));
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

/// sample_surface() without the environment.
SurfaceSamples sample_in_scene(const Scene& scene, int64_t count, const SamplerOptions& options) {
  const std::vector<const PunctualLight*> lights = local_lights(scene, options);
  const int64_t surface = count - static_cast<int64_t>(lights.size());
  LTE_CHECK(surface >= 1, "sample_surface: ", count, " points cannot hold ", lights.size(),
            " punctual lights and the surfaces of scene ", scene.name);

  SurfaceSamples samples = make_samples(count);
  double total = 0;
  if (options.emissive_share > 0 && surface >= 2) {
    const Split split = split_instances(scene);
    const AreaTable emissive(scene, split.emissive), other(scene, split.other);
    total = emissive.total() + other.total();
    check_area(scene, total);
    const double by_area = static_cast<double>(surface) * emissive.total() / total;
    const double wanted = std::ceil(static_cast<double>(surface) * options.emissive_share);
    if (emissive.total() > 0 && other.total() > 0 && wanted > by_area) {
      const int64_t lit = std::min(static_cast<int64_t>(wanted), surface - 1);
      fill(scene, other, 0, surface - lit, options, &samples);
      fill(scene, emissive, surface - lit, lit, options, &samples);
      fill_lights(lights, static_cast<float>(total / static_cast<double>(count)), surface,
                  &samples);
      return samples;
    }
  }
  const AreaTable all(scene, all_instances(scene));
  total = all.total();
  check_area(scene, total);
  fill(scene, all, 0, surface, options, &samples);
  fill_lights(lights, static_cast<float>(total / static_cast<double>(count)), surface, &samples);
  return samples;
}

}  // namespace

int64_t environment_point_count(const Scene& scene, int64_t count, const SamplerOptions& options) {
  if (!scene.environment || options.environment_share == 0) return 0;
  const double wanted = static_cast<double>(count) * options.environment_share;
  return std::max<int64_t>(1, std::llround(wanted));
}

SurfaceSamples sample_surface(const Scene& scene, int64_t count, const SamplerOptions& options) {
  LTE_CHECK(count >= 1, "sample_surface: at least 1 point is needed, got ", count);
  LTE_CHECK(options.emissive_share >= 0 && options.emissive_share < 1,
            "sample_surface: emissive_share must be in [0, 1), got ", options.emissive_share);
  LTE_CHECK(options.environment_share >= 0 && options.environment_share < 1,
            "sample_surface: environment_share must be in [0, 1), got ", options.environment_share);
  const int64_t environment = environment_point_count(scene, count, options);
  LTE_CHECK(environment < count, "sample_surface: ", count,
            " points cannot hold the environment and the ", "surfaces of scene ", scene.name);
  SurfaceSamples samples = sample_in_scene(scene, count - environment, options);
  append_environment_points(scene, environment, &samples);
  return samples;
}

double surface_area(const Scene& scene) { return AreaTable(scene, all_instances(scene)).total(); }

}  // namespace lte::scene
