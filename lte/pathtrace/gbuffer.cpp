#include "lte/pathtrace/gbuffer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>

#include "lte/base/check.h"
#include "lte/base/parallel.h"
#include "lte/pathtrace/blocks/ray_packets.h"
#include "lte/pathtrace/embree_scene.h"
#include "lte/scene/camera_rays.h"
#include "lte/scene/number_check.h"
#include "lte/scene/shading_normal.h"
#include "lte/scene/surface.h"
#include "lte/scene/texel_densities.h"

namespace lte::pathtrace {
namespace {

constexpr int kPacket = 16;  // as many as any machine takes at once

/// Traces primary rays in packets, which gain on coherent rays, and stores what they meet.
class PrimaryTracer {
 public:
  PrimaryTracer(const Bvh& bvh, const scene::Camera& camera, int width, int height, float covered,
                GBuffer* out)
      : bvh_(bvh),
        rays_(camera),
        out_(out),
        width_(static_cast<float>(width)),
        height_(static_cast<float>(height)),
        axis_(normalize(camera.target - camera.origin)),
        origin_(camera.origin - bvh.handles().origin),
        footprint_(covered * pixel_size(camera, height)) {}

  /// Traces `count` image points, at most kPacket, into places `first` and following.
  void trace(const Vec2* points, int count, size_t first, scene::TexelDensities* texels) const {
    if (bvh_.handles().packet_width == kPacket) {
      trace_packet<kPacket>(points, count, first, texels);
      return;
    }
    constexpr int kHalf = kPacket / 2;
    trace_packet<kHalf>(points, std::min(count, kHalf), first, texels);
    if (count > kHalf) trace_packet<kHalf>(points + kHalf, count - kHalf, first + kHalf, texels);
  }

 private:
  template <int N>
  void trace_packet(const Vec2* points, int count, size_t first,
                    scene::TexelDensities* texels) const {
    typename Packet<N>::Hits packet;
    alignas(64) int valid[N];
    set_constants(&packet.ray);
    for (int lane = 0; lane < N; ++lane) {
      valid[lane] = lane < count ? -1 : 0;
      const Vec2& point = points[std::min(lane, count - 1)];
      const Vec3 d = rays_.direction(point.x / width_, point.y / height_, width_ / height_);
      packet.ray.org_x[lane] = origin_.x;
      packet.ray.org_y[lane] = origin_.y;
      packet.ray.org_z[lane] = origin_.z;
      packet.ray.dir_x[lane] = d.x;
      packet.ray.dir_y[lane] = d.y;
      packet.ray.dir_z[lane] = d.z;
      packet.ray.tfar[lane] = INFINITY;
      packet.hit.geomID[lane] = packet.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
    }
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    Packet<N>::kIntersect(valid, bvh_.handles().top, &context, &packet);
    for (int lane = 0; lane < count; ++lane)
      store(packet, lane, first + static_cast<size_t>(lane), texels);
  }

  template <typename Hits>
  void store(const Hits& packet, int lane, size_t i, scene::TexelDensities* texels) const {
    const auto& hit = packet.hit;
    if (hit.geomID[lane] == RTC_INVALID_GEOMETRY_ID) {
      store_background({packet.ray.dir_x[lane], packet.ray.dir_y[lane], packet.ray.dir_z[lane]}, i);
      return;
    }
    const auto instance = static_cast<int>(instance_of(hit.instID[0][lane], hit.geomID[lane]));
    const InstanceRecord& record = bvh_.handles().instances[static_cast<size_t>(instance)];
    const SurfacePoint point = surface_point(record, hit.primID[lane], hit.u[lane], hit.v[lane],
                                             {hit.Ng_x[lane], hit.Ng_y[lane], hit.Ng_z[lane]});
    const Vec3 d{packet.ray.dir_x[lane], packet.ray.dir_y[lane], packet.ray.dir_z[lane]};
    const float cos_front = -dot(point.normal, d);
    const float footprint = packet.ray.tfar[lane] * footprint_;
    Rgb emission = record.emission;
    if (record.uniform) {
      out_->albedo[i] = record.albedo;
    } else {
      scene::evaluate_appearance(bvh_.scene(), instance, hit.primID[lane], hit.u[lane], hit.v[lane],
                                 footprint, texels, &out_->albedo[i], &emission);
    }
    out_->position[i] = point.position + bvh_.handles().origin;
    out_->normal[i] = cos_front >= 0 ? point.normal : -point.normal;
    if (!out_->geometric_normal.empty()) out_->geometric_normal[i] = out_->normal[i];
    if (record.normal_mapped) {
      // Not filtered: a mean of normals is the normal of a smoother, brighter surface.
      const Vec3 bent = scene::shading_normal(bvh_.scene(), instance, hit.primID[lane], hit.u[lane],
                                              hit.v[lane], 0, point.normal);
      out_->normal[i] = cos_front >= 0 ? bent : -bent;
    }
    out_->depth[i] = packet.ray.tfar[lane] * dot(d, axis_);
    out_->mask[i] = 1;
    out_->instance[i] = instance;
    const bool shines = record.emissive && (cos_front > 0 || record.two_sided);
    out_->emission[i] = shines ? emission : Rgb{};
    if (out_->metallic.empty()) return;
    out_->metallic[i] = !record.glossy
                            ? 0
                            : scene::evaluate_gloss(bvh_.scene(), instance, hit.primID[lane],
                                                    hit.u[lane], hit.v[lane], footprint)
                                  .metallic;
  }

  void store_background(const Vec3& direction, size_t i) const {
    const auto& environment = bvh_.scene().environment;
    out_->position[i] = out_->normal[i] = Vec3{};
    out_->albedo[i] = Rgb{};
    out_->emission[i] = environment ? environment->radiance_from(direction) : Rgb{};
    out_->depth[i] = INFINITY;
    out_->mask[i] = 0;
    out_->instance[i] = scene::kNone;
    if (!out_->metallic.empty()) out_->metallic[i] = 0;
    if (!out_->geometric_normal.empty()) out_->geometric_normal[i] = Vec3{};
  }

  const Bvh& bvh_;
  scene::CameraRays rays_;
  GBuffer* out_;
  float width_, height_;
  Vec3 axis_, origin_;
  float footprint_;  // at depth 1, in metres
};

/// Makes room for hits up to `width` * `height`.
void resize(const Bvh& bvh, int width, int height, GBuffer* hits) {
  GBuffer& out = *hits;
  out.width = width;
  out.height = height;
  const auto count = static_cast<size_t>(width) * static_cast<size_t>(height);
  const auto& instances = bvh.handles().instances;
  const auto any = [&](bool InstanceRecord::*what) {
    return std::any_of(instances.begin(), instances.end(),
                       [&](const InstanceRecord& record) { return record.*what; });
  };
  for (UnfilledVector<Vec3>* values : {&out.position, &out.normal, &out.albedo, &out.emission})
    values->resize(count);
  out.depth.resize(count);
  out.mask.resize(count);
  out.instance.resize(count);
  if (any(&InstanceRecord::glossy)) out.metallic.resize(count);
  if (any(&InstanceRecord::normal_mapped)) out.geometric_normal.resize(count);
}

}  // namespace

void GBuffer::reserve(size_t count) {
  for (UnfilledVector<Vec3>* values : {&position, &normal, &albedo, &emission})
    values->reserve(count);
  depth.reserve(count);
  mask.reserve(count);
  instance.reserve(count);
}

void check_view(const scene::Camera& camera, int width, int height) {
  LTE_CHECK(width > 0 && height > 0, "an image needs a positive size, got ", width, "x", height);
  LTE_CHECK(scene::is_place(camera.origin) && is_finite(camera.target) && is_finite(camera.up),
            "camera ", camera.name,
            ": origin, target or up is not finite, or the origin farther than ",
            scene::kMaxCoordinate, " from the scene's");
  LTE_CHECK(camera.vfov > 0 && camera.vfov < 180, "camera ", camera.name,
            ": vfov must lie between 0 and 180 degrees, got ", camera.vfov);
  LTE_CHECK(is_finite(camera.direction(0.5f, 0.5f, 1)) &&
                length(camera.target - camera.origin) > 0 &&
                length(cross(camera.target - camera.origin, camera.up)) > 0,
            "camera ", camera.name,
            ": origin and target must differ, and up must not lie along the view");
}

float pixel_size(const scene::Camera& camera, int height) {
  return 2 * std::tan(camera.vfov * kPi / 360) / static_cast<float>(height);
}

GBuffer trace_gbuffer(const Bvh& bvh, const scene::Camera& camera, int width, int height) {
  return trace_gbuffer_rows(bvh, camera, width, height, 0, height);
}

GBuffer trace_gbuffer_rows(const Bvh& bvh, const scene::Camera& camera, int width, int height,
                           int first, int last) {
  check_view(camera, width, height);
  LTE_CHECK(first >= 0 && first < last && last <= height, "rows ", first, " to ", last,
            " do not lie in a picture of ", height);
  GBuffer out;
  resize(bvh, width, last - first, &out);
  const PrimaryTracer tracer(bvh, camera, width, height, 1, &out);
  parallel_for(last - first, 4, [&](int64_t begin, int64_t end) {
    std::array<Vec2, kPacket> points;
    scene::TexelDensities texels;
    for (int64_t row = begin; row < end; ++row) {
      const float y = static_cast<float>(first + row) + 0.5f;
      for (int x = 0; x < width; x += kPacket) {
        const int count = std::min(kPacket, width - x);
        for (int lane = 0; lane < count; ++lane)
          points[static_cast<size_t>(lane)] = {static_cast<float>(x + lane) + 0.5f, y};
        tracer.trace(points.data(), count,
                     static_cast<size_t>(row) * static_cast<size_t>(width) + static_cast<size_t>(x),
                     &texels);
      }
    }
  });
  return out;
}

GBuffer rows_of(const GBuffer& hits, int first, int last) {
  LTE_CHECK(first >= 0 && first < last && last <= hits.height, "rows ", first, " to ", last,
            " do not lie in a picture of ", hits.height);
  const auto part = [&](const auto& values) {
    const auto begin = values.begin() + int64_t{first} * hits.width;
    return std::decay_t<decltype(values)>(begin, begin + int64_t{last - first} * hits.width);
  };
  GBuffer out;
  out.width = hits.width;
  out.height = last - first;
  out.position = part(hits.position);
  out.normal = part(hits.normal);
  out.albedo = part(hits.albedo);
  out.emission = part(hits.emission);
  out.depth = part(hits.depth);
  out.mask = part(hits.mask);
  out.instance = part(hits.instance);
  if (!hits.metallic.empty()) out.metallic = part(hits.metallic);
  if (!hits.geometric_normal.empty()) out.geometric_normal = part(hits.geometric_normal);
  return out;
}

void append_image_points(const Bvh& bvh, const scene::Camera& camera, int width, int height,
                         std::span<const Vec2> points, GBuffer* row, float covered) {
  check_view(camera, width, height);
  const size_t known = row->mask.size();
  resize(bvh, static_cast<int>(known + points.size()), 1, row);
  const PrimaryTracer tracer(bvh, camera, width, height, covered, row);
  const auto count = static_cast<int64_t>(points.size());
  parallel_for(count, int64_t{64} * kPacket, [&](int64_t begin, int64_t end) {
    scene::TexelDensities texels;
    for (int64_t i = begin; i < end; i += kPacket) {
      tracer.trace(points.data() + i, static_cast<int>(std::min<int64_t>(kPacket, end - i)),
                   known + static_cast<size_t>(i), &texels);
    }
  });
}

}  // namespace lte::pathtrace
