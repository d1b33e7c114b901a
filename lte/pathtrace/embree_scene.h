// Internal: Embree's handles, and from a hit to the surface there. Coordinates are relative to the
// frame origin.
#pragma once

#include <cstdint>
#include <vector>

#include <embree3/rtcore.h>

#include "lte/base/math.h"
#include "lte/pathtrace/bvh.h"
#include "lte/scene/scene.h"

namespace lte::pathtrace {

/// Rounding of a point that barycentrics, the instance transform and Embree's inverse of it
/// produce, relative to the magnitudes that went in: the sum of the γ bounds is about 15 · 2^-24
/// (Pharr et al., Physically Based Rendering 3.9).
inline constexpr float kSurfaceError = 0x1p-19f;

/// What a hit needs to know of its instance, in one place.
struct InstanceRecord {
  const scene::Mesh* mesh = nullptr;  ///< null for an instance that is not traced
  Affine to_frame;
  std::array<Vec3, 3>
      normal_rows;        ///< inverse transpose: keeps the front of mirrored instances in front
  float scale = 0;        ///< largest row sum of |M|
  float translation = 0;  ///< largest |translation|
  Rgb albedo, emission;   ///< valid if `uniform`
  scene::Gloss gloss;     ///< likewise
  bool uniform = false;   ///< no texture and no vertex colours
  bool glossy = false;    ///< metal, at least in places
  bool emissive = false, two_sided = false;
  int light_group = scene::kNone;
};

struct Bvh::Handles {
  RTCDevice device = nullptr;
  RTCScene top = nullptr;
  std::vector<RTCScene> meshes;  ///< null for meshes without triangles
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
  ray->org_x = origin.x, ray->org_y = origin.y, ray->org_z = origin.z;
  ray->dir_x = direction.x, ray->dir_y = direction.y, ray->dir_z = direction.z;
  ray->tnear = t_min, ray->tfar = t_max;
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

inline Vec3 abs(const Vec3& a) { return {std::fabs(a.x), std::fabs(a.y), std::fabs(a.z)}; }

inline Vec3 frame_normal(const InstanceRecord& record, const Vec3& n) {
  const Vec3 front{dot(record.normal_rows[0], n), dot(record.normal_rows[1], n),
                   dot(record.normal_rows[2], n)};
  return front * (1 / length(front));
}

/// The point from its barycentrics: its error depends on the triangle's coordinates, not on the
/// length of the ray.
inline SurfacePoint surface_point(const InstanceRecord& record, uint32_t triangle, float u, float v,
                                  const Vec3& geometric_normal) {
  const auto& corners = record.mesh->triangles[triangle];
  const Vec3* positions = record.mesh->positions.data();
  const Vec3 a = positions[corners[0]] * (1 - u - v);
  const Vec3 b = positions[corners[1]] * u;
  const Vec3 c = positions[corners[2]] * v;
  const float magnitude = max_component(abs(a) + abs(b) + abs(c));
  return {record.to_frame.point(a + b + c), frame_normal(record, geometric_normal),
          kSurfaceError * (magnitude * record.scale + record.translation)};
}

}  // namespace lte::pathtrace
