// Internal: the light transport that irradiance and images share. A path is a random walk over
// diffuse surfaces with next-event estimation at each vertex; both ways of meeting a light are
// weighted by the balance heuristic.
//
// A query point is treated as a white diffuse vertex whose reflected radiance is E / π, so
// irradiance needs no code of its own. `Sink` receives contributions: sink.add(light_group, depth,
// rgb), depth counting surface hits after the query point. `Recorder` sees every ray; NoRecorder
// compiles to nothing.
#pragma once

#include <cstdint>

#include "lte/base/math.h"
#include "lte/pathtrace/embree_scene.h"
#include "lte/pathtrace/lights.h"
#include "lte/pathtrace/path_sampler.h"

namespace lte::pathtrace {

struct NoRecorder {
  void nearest(const Vec3&, const Vec3&) {}
  void shadow(const Vec3&, const Vec3&, float) {}
};

/// Where a path stands before its next ray.
struct PathState {
  Vec3 origin, direction;  ///< relative to the frame origin; direction is unit
  Vec3 normal;             ///< at the origin, of the side that the path left; zero for a camera
  Rgb throughput{1, 1, 1};
  float pdf = 0;  ///< solid-angle density of `direction`; 0 if no light sample competes with it (a
                  ///< camera ray)
};

/// cos(2πu) and sin(2πu) up to the sign of both, for u in [0, 1): Taylor polynomials of the half
/// angle (error 6e-8) and its doubling. No branch and no range reduction, which cost as much as a
/// short ray.
inline Vec2 unit_circle(float u) {
  const float a = kPi * (u - 0.5f), x = a * a;
  const float s =
      a *
      (1 + x * (-1.0f / 6 + x * (1.0f / 120 + x * (-1.0f / 5040 +
                                                   x * (1.0f / 362880 + x * (-1.0f / 39916800))))));
  const float c =
      1 +
      x * (-1.0f / 2 +
           x * (1.0f / 24 + x * (-1.0f / 720 + x * (1.0f / 40320 + x * (-1.0f / 3628800 +
                                                                        x * (1.0f / 479001600))))));
  return {1 - 2 * s * s, 2 * s * c};
}

/// A cosine-distributed unit direction around `normal`; `pdf` is its solid-angle density, cosine /
/// π.
inline Vec3 cosine_direction(const Vec3& normal, const Vec2& u, float* pdf) {
  const float radius = std::sqrt(u.x);
  const Vec2 around = unit_circle(u.y);
  const float cosine = std::sqrt(1 - u.x);  // positive: u.x < 1
  Vec3 tangent, bitangent;
  make_frame(normal, &tangent, &bitangent);
  *pdf = cosine * (1 / kPi);
  return tangent * (radius * around.x) + bitangent * (radius * around.y) + normal * cosine;
}

template <typename Recorder>
class Transport {
 public:
  Transport(const Bvh& bvh, const Lights& lights, int max_depth, int roulette_depth,
            Recorder& recorder)
      : handles_(bvh.handles()),
        scene_(bvh.scene()),
        lights_(lights),
        max_depth_(max_depth),
        roulette_depth_(roulette_depth),
        recorder_(recorder) {}

  int64_t rays_traced() const { return rays_traced_; }

  /// Light that one sample brings to a vertex and on along the path.
  /// @param weight  throughput times albedo
  /// @param depth   of the light, seen from the query point
  template <typename Sink>
  void sample_light(const Vec3& origin, const Vec3& normal, const Rgb& weight, double u_choice,
                    const Vec2& u_point, int depth, Sink& sink) {
    const LightSample light = lights_.sample_in_frame(origin, normal, u_choice, u_point);
    const float cos_surface = dot(normal, light.direction);
    if (!(light.pdf > 0) || !(cos_surface > 0)) return;
    const float bsdf_pdf = cos_surface * (1 / kPi);
    const float density = light.delta ? light.pdf : light.pdf + bsdf_pdf;
    const Rgb contribution = weight * light.radiance * (bsdf_pdf / density);
    if (!(max_component(contribution) > 0)) return;
    const float distance = light.distance * kShadowLength;
    recorder_.shadow(origin, light.direction, distance);
    ++rays_traced_;
    if (occluded(handles_.top, origin, light.direction, distance)) return;
    sink.add(light.light_group, depth, contribution);
  }

  /// Traces a path to its end. The first hit has depth 1.
  template <typename Sink>
  void follow(PathState path, PathSampler& sampler, Sink& sink) {
    for (int depth = 1; depth <= max_depth_; ++depth) {
      // The last ray can only find an area light.
      if (depth == max_depth_ && !lights_.has_area_lights()) return;
      RTCRayHit hit;
      recorder_.nearest(path.origin, path.direction);
      ++rays_traced_;
      if (!intersect(handles_.top, path.origin, path.direction, &hit)) return;
      if (!shade(hit, depth, &path, sampler, sink)) return;
    }
  }

 private:
  /// Light samples stand off their surface already; this only covers rounding of the distance.
  static constexpr float kShadowLength = 1 - 0x1p-20f;

  /// Emission, next-event estimation and the next direction at a hit; false ends the path.
  template <typename Sink>
  bool shade(const RTCRayHit& hit, int depth, PathState* path, PathSampler& sampler, Sink& sink) {
    const auto instance = static_cast<int>(hit.hit.instID[0]);
    const InstanceRecord& record = handles_.instances[instance];
    const bool last = depth == max_depth_;
    if (last && !record.emissive) return false;
    Rgb albedo = record.albedo, emission = record.emission;
    if (!record.uniform) {
      scene::evaluate_appearance(scene_, instance, hit.hit.primID, hit.hit.u, hit.hit.v, 0, &albedo,
                                 &emission);
    }
    const SurfacePoint point = surface_point(record, hit.hit.primID, hit.hit.u, hit.hit.v,
                                             {hit.hit.Ng_x, hit.hit.Ng_y, hit.hit.Ng_z});
    const float cos_front = -dot(point.normal, path->direction);
    if (record.emissive && (cos_front > 0 || record.two_sided)) {
      const float distance = hit.ray.tfar;
      const float weight =
          light_weight(*path, instance, hit.hit.primID, distance * distance, std::fabs(cos_front));
      sink.add(record.light_group, depth, path->throughput * emission * weight);
    }
    if (last) return false;
    path->throughput *= albedo;
    if (!(max_component(path->throughput) > 0)) return false;
    const Vec3 side = cos_front >= 0 ? point.normal : -point.normal;
    const Vec3 origin = point.position + side * point.offset;
    const double u_choice = sampler.light_choice(depth);
    const Vec2 u_point = sampler.light_point(depth);
    sample_light(origin, side, path->throughput, u_choice, u_point, depth + 1, sink);
    if (depth >= roulette_depth_ && !survive(&path->throughput, sampler.roulette(depth)))
      return false;
    path->origin = origin;
    path->normal = side;
    path->direction = cosine_direction(side, sampler.direction(depth), &path->pdf);
    return true;
  }

  /// Balance heuristic for a light met by hitting it.
  float light_weight(const PathState& path, int instance, uint32_t triangle, float distance2,
                     float cos_light) const {
    if (!(path.pdf > 0)) return 1;
    const float light_pdf =
        lights_.pdf(path.origin, path.normal, instance, triangle, distance2, cos_light);
    return path.pdf / (path.pdf + light_pdf);
  }

  static bool survive(Rgb* throughput, float u) {
    const float probability = max_component(*throughput);
    if (probability >= 1) return true;
    if (u >= probability) return false;
    *throughput *= 1 / probability;
    return true;
  }

  const Bvh::Handles& handles_;
  const scene::Scene& scene_;
  const Lights& lights_;
  const int max_depth_, roulette_depth_;
  Recorder& recorder_;
  int64_t rays_traced_ = 0;
};

}  // namespace lte::pathtrace
