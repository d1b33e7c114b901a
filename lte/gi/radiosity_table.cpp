#include "lte/gi/radiosity_table.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lte/base/check.h"
#include "lte/base/parallel.h"
#include "lte/pathtrace/irradiance.h"
#include "lte/scene/sampler.h"

namespace lte::gi {
namespace {

constexpr double kEmissiveShare = 0.1;
// Of a cell of the index, in radii: look-ups are many.
constexpr float kCell = 0.5f;
// Estimates keep two colors an entry and light group: blocks bound that memory.
constexpr int64_t kEstimateBlock = int64_t{1} << 21;
constexpr int64_t kGrain = 64;
// Rays along a surface rise by this much a metre: they pass the unevenness of the surface itself.
constexpr float kRise = 0.15f;

int octant(float x, float y) {
  return (y < 0 ? 4 : 0) + (x < 0 ? 2 : 0) + (std::fabs(y) > std::fabs(x) ? 1 : 0);
}

/// Directions to the middles of these octants.
Vec2 octant_middle(int octant) {
  constexpr float kNear = 0.38268343f, kFar = 0.92387953f;  // of 22.5 degrees
  const bool steep = octant % 2 == 1;
  const float x = steep ? kNear : kFar, y = steep ? kFar : kNear;
  return {octant & 2 ? -x : x, octant & 4 ? -y : y};
}

}  // namespace

TableEntries TableEntries::kept(std::span<const uint8_t> keep) const {
  LTE_CHECK(keep.size() == position.size(), "table entries: ", position.size(), " but ",
            keep.size(), " flags");
  TableEntries out;
  for (size_t i = 0; i < keep.size(); ++i) {
    if (keep[i] == 0) continue;
    out.position.push_back(position[i]);
    out.normal.push_back(normal[i]);
    out.albedo.push_back(albedo[i]);
    out.area.push_back(area[i]);
  }
  return out;
}

TableEntries sample_entries(const scene::Scene& scene, int64_t count, uint64_t seed) {
  LTE_CHECK(count >= 1, "a table needs at least one entry, got ", count);
  scene::SamplerOptions options;
  options.seed = seed;
  options.emissive_share = kEmissiveShare;
  options.environment_share = 0;
  options.punctual_lights = false;
  const scene::SurfaceSamples samples = scene::sample_surface(scene, (count + 1) / 2, options);
  TableEntries out;
  for (size_t i = 0; i < samples.position.size(); ++i) {
    if (!(dot(samples.normal[i], samples.normal[i]) > 0.5f) || !(samples.area[i] > 0)) continue;
    for (const Vec3& side : {samples.normal[i], -samples.normal[i]}) {
      out.position.push_back(samples.position[i]);
      out.normal.push_back(side);
      out.albedo.push_back(samples.albedo[i]);
      out.area.push_back(samples.area[i]);
    }
  }
  return out;
}

std::vector<Rgb> EntryLight::total() const {
  std::vector<Rgb> sum(direct);
  for (size_t i = 0; i < sum.size(); ++i) sum[i] += indirect[i];
  return sum;
}

EntryLight estimate_entries(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                            const TableEntries& entries, int paths, int max_depth, uint64_t seed) {
  pathtrace::IrradianceOptions options;
  options.rays = paths;
  options.max_depth = max_depth;
  options.seed = seed;
  options.variance = false;
  options.direct_only = max_depth == 1;
  EntryLight out;
  const int64_t block = std::max<int64_t>(1, kEstimateBlock / std::max(1, lights.groups()));
  for (int64_t first = 0; first < entries.size(); first += block) {
    const auto begin = static_cast<size_t>(first);
    const auto count = static_cast<size_t>(std::min(block, entries.size() - first));
    const pathtrace::Irradiance light = pathtrace::estimate_irradiance(
        bvh, lights, std::span(entries.position).subspan(begin, count),
        std::span(entries.normal).subspan(begin, count), options, first);
    for (int64_t i = 0; i < light.points; ++i) {
      out.direct.push_back(light.direct_sum(i));
      out.indirect.push_back(light.indirect_sum(i));
    }
    out.rays_traced += light.rays_traced;
  }
  return out;
}

std::vector<uint8_t> lit(const EntryLight& light) {
  std::vector<uint8_t> out(light.direct.size());
  for (size_t i = 0; i < out.size(); ++i)
    out[i] = max_component(light.direct[i]) > 0 || max_component(light.indirect[i]) > 0;
  return out;
}

RadiosityTable::RadiosityTable(const pathtrace::Bvh& bvh, const TableEntries& entries,
                               std::vector<Rgb> irradiance, const TableOptions& options)
    : least_weight_(options.least_weight) {
  LTE_CHECK(irradiance.size() == entries.position.size(), "radiosity table: ", entries.size(),
            " entries but ", irradiance.size(), " irradiances");
  LTE_CHECK(options.radius > 0, "radiosity table: radius must be positive, got ", options.radius);
  std::vector<float> radii;
  double sum = 0;
  for (size_t i = 0; i < irradiance.size(); ++i) {
    LTE_CHECK(is_finite(irradiance[i]), "radiosity table: irradiance ", i, " is not finite");
    radii.push_back(options.radius * std::sqrt(entries.area[i]));
    sum += radii.back();
  }
  if (irradiance.empty()) return;
  radius_ = static_cast<float>(sum / static_cast<double>(radii.size()));
  index_ = SurfaceIndex(entries.position, entries.normal, radii, kCell);
  index_.pack();
  entries_.resize(irradiance.size());
  std::vector<Walls> around(irradiance.size());
  std::vector<uint8_t> has_walls(irradiance.size());
  parallel_for(entries.size(), kGrain, [&](int64_t begin, int64_t end) {
    for (auto i = static_cast<size_t>(begin); i < static_cast<size_t>(end); ++i)
      has_walls[i] = find_walls(bvh, entries.position[i], entries.normal[i], radii[i], &around[i]);
  });
  for (size_t i = 0; i < irradiance.size(); ++i) {
    entries_[i].irradiance = irradiance[i];
    if (!has_walls[i]) continue;
    entries_[i].walls = static_cast<uint32_t>(walls_.size());
    walls_.push_back(around[i]);
  }
}

/// Traces a ray into each octant. What it meets counts as a plane wall.
bool RadiosityTable::find_walls(const pathtrace::Bvh& bvh, const Vec3& position, const Vec3& normal,
                                float radius, Walls* walls) {
  make_frame(normal, &walls->tangent, &walls->bitangent);
  pathtrace::Ray ray;
  ray.origin =
      pathtrace::offset_origin(position, normal, 0.5f * max_component(bvh.bounds().extent()));
  ray.t_max = radius;
  bool any = false;
  for (int k = 0; k < 8; ++k) {
    const Vec2 along = octant_middle(k);
    ray.direction = walls->tangent * along.x + walls->bitangent * along.y + normal * kRise;
    const pathtrace::Hit hit = bvh.intersect(ray);
    if (!hit.valid()) continue;
    Walls::Plane plane{dot(hit.normal, walls->tangent), dot(hit.normal, walls->bitangent), 0};
    plane.distance = hit.t * (plane.x * along.x + plane.y * along.y);
    if (plane.distance < 0) plane = {-plane.x, -plane.y, -plane.distance};
    walls->plane[static_cast<size_t>(k)] = plane;
    any = true;
  }
  return any;
}

bool RadiosityTable::Walls::hides(const Vec3& offset) const {
  const float x = dot(offset, tangent), y = dot(offset, bitangent);
  const Plane& wall = plane[static_cast<size_t>(octant(x, y))];
  return x * wall.x + y * wall.y > wall.distance;
}

bool RadiosityTable::lookup(const Vec3& position, const Vec3& normal, Rgb* irradiance) const {
  Rgb sum;
  float weights = 0;
  index_.for_each(position, normal, [&](uint32_t i, float weight, const Vec3& offset) {
    const Entry& entry = entries_[i];
    if (entry.walls != kNone && walls_[entry.walls].hides(offset)) return;
    sum += entry.irradiance * weight;
    weights += weight;
  });
  if (!(weights >= least_weight_)) return false;
  *irradiance = sum * (1 / weights);
  return true;
}

}  // namespace lte::gi
