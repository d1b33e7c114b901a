#include "lte/gi/irradiance_cache.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lte/base/check.h"
#include "lte/base/parallel_each.h"
#include "lte/pathtrace/ray_offset.h"

namespace lte::gi {
namespace {

// Of a cell of the index, in radii: look-ups are many.
constexpr float kCell = 0.5f;
constexpr int64_t kGrain = 64;
// Rays along a surface rise by this much a metre: they pass the unevenness of the surface itself.
constexpr float kRise = 0.15f;
// Of a record's weight, what the narrowest gap leaves.
constexpr float kLeastShare = 1e-3f;

float gray(const Rgb& light) { return light.x + light.y + light.z; }

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

IrradianceCache::IrradianceCache(const pathtrace::Bvh& bvh, const CacheRecords& records,
                                 std::span<const Rgb> irradiance, std::span<const Rgb> direct,
                                 std::span<const float> direct_variance,
                                 std::span<const Rgb> shorter, const CacheOptions& options)
    : records_(records.position.size()), options_(options) {
  LTE_CHECK(direct.empty() || direct.size() == records_.size(),
            "irradiance cache: ", records_.size(), " records but ", direct.size(),
            " of direct light");
  LTE_CHECK(direct_variance.empty() || direct_variance.size() == direct.size(),
            "irradiance cache: ", direct.size(), " of direct light but ", direct_variance.size(),
            " variances");
  LTE_CHECK(options.radius > 0, "irradiance cache: radius must be positive, got ", options.radius);
  std::vector<float> radii;
  double sum = 0;
  for (const float area : records.area) {
    radii.push_back(options.radius * std::sqrt(area));
    sum += radii.back();
  }
  const auto places = std::make_shared<Places>();
  if (!radii.empty()) {
    places->radius = static_cast<float>(sum / static_cast<double>(radii.size()));
    places->index = SurfaceIndex(records.position, records.normal, radii, kCell);
    places->index.pack();
    places->lamps = NearLamps(bvh.scene(), options.near_lamps * places->radius);
  }
  std::vector<Walls> around(records_.size());
  std::vector<uint8_t> has_walls(records_.size());
  parallel_each(records_.size(), kGrain, [&](size_t i) {
    float open = 1;
    has_walls[i] =
        find_walls(bvh, records.position[i], records.normal[i], radii[i], &around[i], &open);
    // Rays come to what lies open, and seldom to what stands in gaps beside it, where it is dark:
    // with equal weights a furnished room would lose a per cent or two of its light a bounce.
    records_[i].share = std::max(kLeastShare, open);
  });
  for (size_t i = 0; i < records_.size(); ++i) {
    LTE_CHECK(direct.empty() || is_finite(direct[i]), "irradiance cache: direct light ", i,
              " is not finite");
    if (!direct.empty()) records_[i].direct = gray(direct[i]);
    if (!direct_variance.empty()) records_[i].noise = direct_variance[i];
    if (!has_walls[i]) continue;
    records_[i].walls = static_cast<uint32_t>(places->walls.size());
    places->walls.push_back(around[i]);
  }
  places_ = places;
  set_light(records, irradiance, shorter);
}

IrradianceCache IrradianceCache::of(const pathtrace::Bvh& bvh, const CacheRecords& records,
                                    const RecordLight& light) {
  return {bvh, records, light.total(), light.direct, light.direct_variance, light.shorter()};
}

IrradianceCache IrradianceCache::relit(const CacheRecords& records, std::span<const Rgb> irradiance,
                                       std::span<const Rgb> shorter) const {
  IrradianceCache out(*this);
  out.set_light(records, irradiance, shorter);
  return out;
}

IrradianceCache IrradianceCache::answering(std::span<const Rgb> irradiance) const {
  LTE_CHECK(irradiance.size() == records_.size(), "irradiance cache: ", records_.size(),
            " records but ", irradiance.size(), " irradiances");
  IrradianceCache out(*this);
  for (size_t i = 0; i < irradiance.size(); ++i) {
    out.records_[i].irradiance = out.records_[i].shorter = irradiance[i];
  }
  return out;
}

void IrradianceCache::set_light(const CacheRecords& records, std::span<const Rgb> irradiance,
                                std::span<const Rgb> shorter) {
  LTE_CHECK(records.position.size() == records_.size() && irradiance.size() == records_.size(),
            "irradiance cache: ", records.size(), " records but ", irradiance.size(),
            " irradiances");
  LTE_CHECK(shorter.empty() || shorter.size() == irradiance.size(),
            "irradiance cache: ", irradiance.size(), " irradiances but ", shorter.size(),
            " of a bounce less");
  double light = 0, lit = 0;
  for (size_t i = 0; i < irradiance.size(); ++i) {
    LTE_CHECK(is_finite(irradiance[i]), "irradiance cache: irradiance ", i, " is not finite");
    records_[i].irradiance = irradiance[i];
    records_[i].shorter = shorter.empty() ? irradiance[i] : shorter[i];
    records_[i].total = gray(irradiance[i]);
    records_[i].silent = false;
    light += double{gray(irradiance[i])} * double{records.area[i]};
    lit += gray(irradiance[i]) > 0 ? double{records.area[i]} : 0;
  }
  even_below_ = lit > 0 ? options_.even_below * static_cast<float>(light / lit) : 0;
  silence_dark_sheets(records);
  bright_ = BrightPlaces(records, irradiance);
}

bool IrradianceCache::speaks(uint32_t record, const Vec3& offset) const {
  const Record& r = records_[record];
  return !r.silent && (r.walls == kNone || !places_->walls[r.walls].hides(offset));
}

/// Records that paths have found no light at say so beside lit ones: without them the cache would
/// be too bright where light is rare. Those that no lit one leads to, from record to record along
/// surfaces, lie inside of things and below them, or in the dark: nothing is known there.
void IrradianceCache::silence_dark_sheets(const CacheRecords& records) {
  std::vector<uint8_t> reached(records_.size());
  std::vector<uint32_t> open;
  for (uint32_t i = 0; i < records_.size(); ++i) {
    reached[i] = gray(records_[i].irradiance) > 0;
    if (reached[i]) open.push_back(i);
  }
  while (!open.empty()) {
    const uint32_t from = open.back();
    open.pop_back();
    places_->index.for_each(records.position[from], records.normal[from],
                            [&](uint32_t i, float, const Vec3& offset) {
                              if (reached[i] || !speaks(i, offset) || !speaks(from, -offset))
                                return;
                              reached[i] = 1;
                              open.push_back(i);
                            });
  }
  for (uint32_t i = 0; i < records_.size(); ++i) {
    // What stands near a lamp knows light that ends there: it would carry it on.
    records_[i].silent =
        !reached[i] || places_->lamps.above(records.position[i], records.normal[i]);
  }
}

/// Traces a ray into each octant. What it meets counts as a plane wall.
bool IrradianceCache::find_walls(const pathtrace::Bvh& bvh, const Vec3& position,
                                 const Vec3& normal, float radius, Walls* walls, float* open) {
  make_frame(normal, &walls->tangent, &walls->bitangent);
  pathtrace::Ray ray;
  ray.origin =
      pathtrace::offset_origin(position, normal, 0.5f * max_component(bvh.bounds().extent()));
  ray.t_max = radius;
  bool any = false;
  float seen = 0;
  for (int k = 0; k < 8; ++k) {
    const Vec2 along = octant_middle(k);
    ray.direction = walls->tangent * along.x + walls->bitangent * along.y + normal * kRise;
    const pathtrace::Hit hit = bvh.intersect(ray);
    seen += hit.valid() ? hit.t / radius : 1;
    if (!hit.valid()) continue;
    Walls::Plane plane{dot(hit.normal, walls->tangent), dot(hit.normal, walls->bitangent), 0};
    plane.distance = hit.t * (plane.x * along.x + plane.y * along.y);
    if (plane.distance < 0) plane = {-plane.x, -plane.y, -plane.distance};
    walls->plane[static_cast<size_t>(k)] = plane;
    any = true;
  }
  *open = std::sqrt(seen / 8);
  walls->normal = normal;
  for (const float side : {1.0f, -1.0f}) {
    ray.direction = normal * side;
    ray.origin = pathtrace::offset_origin(position, ray.direction,
                                          0.5f * max_component(bvh.bounds().extent()));
    ray.t_max = side > 0 ? radius : SurfaceIndex::kPlane * radius;
    const pathtrace::Hit hit = bvh.intersect(ray);
    if (!hit.valid()) continue;
    if (side > 0) *open *= std::sqrt(hit.t / radius);
    if (hit.t > SurfaceIndex::kPlane * radius) continue;
    (side > 0 ? walls->above : walls->below) = 0.5f * hit.t;
    any = true;
  }
  return any;
}

bool IrradianceCache::Walls::hides(const Vec3& offset) const {
  const float x = dot(offset, tangent), y = dot(offset, bitangent), z = dot(offset, normal);
  if (z > above || z < -below) return true;
  const Plane& wall = plane[static_cast<size_t>(octant(x, y))];
  return x * wall.x + y * wall.y > wall.distance;
}

bool IrradianceCache::lookup(const Vec3& position, const Vec3& normal, Rgb* irradiance,
                             int hit) const {
  if (places_->lamps.above(position, normal)) return false;
  Rgb sum;
  float weights = 0, shares = 0, total = 0, direct = 0, squares = 0, noise = 0;
  places_->index.for_each(position, normal, [&](uint32_t i, float weight, const Vec3& offset) {
    if (!speaks(i, offset)) return;
    const Record& record = records_[i];
    sum += (hit > 1 ? record.shorter : record.irradiance) * (weight * record.share);
    shares += weight * record.share;
    weights += weight;
    total += record.total * weight;
    direct += record.direct * weight;
    squares += (record.direct * record.direct - record.noise) * weight;
    noise += record.noise * weight * weight;
  });
  if (!(weights >= options_.least_weight)) return false;
  const float scale = 1 / weights, mean = direct * scale;
  *irradiance = sum / shares;
  const float bound = options_.uneven * total * scale + even_below_;
  // Expected squares hold the variance of each record, that of the mean what is left in the mean.
  return squares * scale - mean * mean + noise * scale * scale <= bound * bound;
}

}  // namespace lte::gi
