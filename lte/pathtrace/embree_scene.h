// Internal: Embree's handles, and from a hit to the surface there. Coordinates are relative to the
// frame origin.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <vector>

#include <embree3/rtcore.h>

#include "lte/base/math.h"
#include "lte/pathtrace/bvh.h"
#include "lte/scene/scene.h"
#include "lte/scene/surface.h"

namespace lte::pathtrace {

/// Rounding of a point that barycentrics, the instance transform and Embree's inverse of it
/// produce, relative to the magnitudes that went in: the sum of the γ bounds is about 15 · 2^-24
/// (Pharr et al., Physically Based Rendering 3.9).
inline constexpr float kSurfaceError = 0x1p-19f;

/// Four floats that are added and multiplied at once. A vector is in the first three; the fourth is
/// whatever lies behind it in memory.
using Float4 = float __attribute__((vector_size(16)));

inline Float4 load_float4(const float* from) {
  Float4 out;
  std::memcpy(&out, from, sizeof(out));
  return out;
}

/// What a hit needs to know of its instance, in one place.
struct InstanceRecord {
  Float4 columns[4] = {};  ///< of the transform to the frame, translation last
  /// Columns of its inverse transpose, which keeps the front of mirrored instances in front.
  Float4 normal_columns[3] = {};
  const std::array<uint32_t, 3>* triangles = nullptr;  ///< null for an instance that is not traced
  const float* positions = nullptr;  ///< Embree's copy, padded: the last vertex can be loaded too
  float scale = 0;                   ///< largest row sum of |M|
  float translation = 0;             ///< largest |translation|
  Rgb albedo, emission;              ///< valid if `uniform`
  scene::Gloss gloss;                ///< likewise
  bool uniform = false;              ///< no texture and no vertex colors
  bool glossy = false;               ///< metal, at least in places
  bool normal_mapped = false;        ///< its shading normals are not the geometric ones
  bool emissive = false, two_sided = false;
  int light_group = scene::kNone;
};

struct Bvh::Handles {
  RTCDevice device = nullptr;
  RTCScene top = nullptr;
  std::vector<RTCScene> meshes;  ///< null for meshes without triangles
  bool own_indices = false;      ///< meshes borrow nothing of the scene
  std::vector<InstanceRecord> instances;
  Vec3 origin;
  int packet_width = 4;  ///< rays that Embree takes at once on this machine

  Handles() = default;
  ~Handles();
  Handles(const Handles&) = delete;
  Handles& operator=(const Handles&) = delete;
};

/// The geometry of a hit. `normal` is the front side's.
struct SurfacePoint {
  Vec3 position, normal;
  float offset = 0;  ///< distance off the surface that keeps rays from meeting it again
};

inline void set_ray(RTCRay* ray, const Vec3& origin, const Vec3& direction, float t_min,
                    float t_max) {
  ray->org_x = origin.x;
  ray->org_y = origin.y;
  ray->org_z = origin.z;
  ray->dir_x = direction.x;
  ray->dir_y = direction.y;
  ray->dir_z = direction.z;
  ray->tnear = t_min;
  ray->tfar = t_max;
  ray->time = 0;
  ray->mask = ~0u;
  ray->id = 0;
  ray->flags = 0;
}

inline bool intersect(RTCScene top, const Vec3& origin, const Vec3& direction, RTCRayHit* hit) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  set_ray(&hit->ray, origin, direction, 0, INFINITY);
  hit->hit.geomID = hit->hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(top, &context, hit);
  return hit->hit.geomID != RTC_INVALID_GEOMETRY_ID;
}

inline bool occluded(RTCScene top, const Vec3& origin, const Vec3& direction, float t_max) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRay ray;
  set_ray(&ray, origin, direction, 0, t_max);
  rtcOccluded1(top, &context, &ray);
  return ray.tfar < 0;  // Embree's sign for occluded
}

/// The instance that a ray has met. Flat ones have no scene of their own; the number of a miss is
/// scene::kNone.
inline uint32_t instance_of(uint32_t instance, uint32_t geometry) {
  return instance != RTC_INVALID_GEOMETRY_ID ? instance : geometry;
}

inline Vec3 abs(const Vec3& a) { return {std::fabs(a.x), std::fabs(a.y), std::fabs(a.z)}; }

/// Unit normal of the front from Embree's.
inline Vec3 frame_normal(const InstanceRecord& record, const Vec3& n) {
  const Float4* columns = record.normal_columns;
  const Float4 front = columns[0] * n.x + columns[1] * n.y + columns[2] * n.z;
  const Vec3 scaled{front[0], front[1], front[2]};
  return scaled * (1 / length(scaled));
}

/// The point from its barycentrics: its error depends on the triangle's coordinates, not on the
/// length of the ray.
inline SurfacePoint surface_point(const InstanceRecord& record, uint32_t triangle, float u, float v,
                                  const Vec3& geometric_normal) {
  const auto& corners = record.triangles[triangle];
  const auto corner = [&](int k) { return load_float4(record.positions + size_t{3} * corners[k]); };
  const auto absolute = [](const Float4& x) { return x < 0 ? -x : x; };
  const Float4 a = corner(0) * (1 - u - v), b = corner(1) * u, c = corner(2) * v;
  const Float4 p = a + b + c, size = absolute(a) + absolute(b) + absolute(c);
  const Float4 placed = record.columns[0] * p[0] + record.columns[1] * p[1] +
                        record.columns[2] * p[2] + record.columns[3];
  const float magnitude = std::max({size[0], size[1], size[2]});
  return {{placed[0], placed[1], placed[2]},
          frame_normal(record, geometric_normal),
          kSurfaceError * (magnitude * record.scale + record.translation)};
}

}  // namespace lte::pathtrace
