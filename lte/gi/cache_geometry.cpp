#include "lte/gi/cache_geometry.h"

#include <algorithm>

#include "lte/base/check.h"
#include "lte/base/parallel_each.h"
#include "lte/pathtrace/ray_offset.h"

namespace lte::gi {
namespace {

// How far a record speaks for its surroundings, in edges of the square that it stands for.
constexpr float kRadius = 1.5f;
// Of a cell of the index, in radii: look-ups are many.
constexpr float kCell = 0.5f;
// Nearer than so many mean radii to a small lamp the records do not know the light.
constexpr float kNearLamps = 0.5f;
constexpr int64_t kGrain = 64;
// Rays along a surface rise by this much a metre: they pass the unevenness of the surface itself.
constexpr float kRise = 0.15f;
// Of a record's weight, what the narrowest gap leaves.
constexpr float kLeastShare = 1e-3f;

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

CacheGeometry::CacheGeometry(const pathtrace::Bvh& bvh, const CacheRecords& records) {
  if (records.position.empty()) return;
  std::vector<float> radii;
  double sum = 0;
  for (const float area : records.area) {
    radii.push_back(kRadius * std::sqrt(area));
    sum += radii.back();
  }
  const size_t count = radii.size();
  radius_ = static_cast<float>(sum / static_cast<double>(count));
  index_ = SurfaceIndex(records.position, records.normal, radii, kCell);
  index_.pack();
  lamps_ = NearLamps(bvh.scene(), kNearLamps * radius_);
  around_.resize(count);
  std::vector<Walls> walls(count);
  std::vector<uint8_t> has_walls(count);
  parallel_each(count, kGrain, [&](size_t i) {
    float open = 1;
    has_walls[i] =
        find_walls(bvh, records.position[i], records.normal[i], radii[i], &walls[i], &open);
    // Rays come to what lies open, and seldom to what stands in gaps beside it, where it is dark:
    // with equal weights a furnished room would lose a per cent or two of its light a bounce.
    around_[i].share = std::max(kLeastShare, open);
  });
  for (size_t i = 0; i < count; ++i) {
    if (!has_walls[i]) continue;
    around_[i].walls = static_cast<uint32_t>(walls_.size());
    walls_.push_back(walls[i]);
  }
}

std::vector<uint8_t> CacheGeometry::dark_sheets(const CacheRecords& records,
                                                std::span<const uint8_t> lit) const {
  LTE_CHECK(records.position.size() == around_.size() && lit.size() == around_.size(),
            "irradiance cache: ", around_.size(), " records stand around, but ", records.size(),
            " were given and ", lit.size(), " are lit or not");
  std::vector<uint8_t> dark(lit.size());
  std::vector<uint32_t> open;
  for (uint32_t i = 0; i < lit.size(); ++i) {
    dark[i] = lit[i] == 0;
    if (!dark[i]) open.push_back(i);
  }
  while (!open.empty()) {
    const uint32_t from = open.back();
    open.pop_back();
    for_each(records.position[from], records.normal[from],
             [&](uint32_t i, float, const Vec3& offset) {
               if (!dark[i] || hidden(i, offset) || hidden(from, -offset)) return;
               dark[i] = 0;
               open.push_back(i);
             });
  }
  return dark;
}

/// Traces a ray into each octant. What it meets counts as a plane wall.
bool CacheGeometry::find_walls(const pathtrace::Bvh& bvh, const Vec3& position, const Vec3& normal,
                               float radius, Walls* walls, float* open) {
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

bool CacheGeometry::Walls::hides(const Vec3& offset) const {
  const float x = dot(offset, tangent), y = dot(offset, bitangent), z = dot(offset, normal);
  if (z > above || z < -below) return true;
  const Plane& wall = plane[static_cast<size_t>(octant(x, y))];
  return x * wall.x + y * wall.y > wall.distance;
}

}  // namespace lte::gi
