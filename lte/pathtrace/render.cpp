#include "lte/pathtrace/render.h"

#include <cmath>

#include "lte/base/check.h"
#include "lte/base/parallel.h"
#include "lte/pathtrace/path_sampler.h"
#include "lte/pathtrace/transport.h"

namespace lte::pathtrace {
namespace {

constexpr int kPacket = 8;

void check_view(const scene::Camera& camera, int width, int height) {
  LTE_CHECK(width > 0 && height > 0, "an image needs a positive size, got ", width, "x", height);
  LTE_CHECK(is_finite(camera.origin) && is_finite(camera.target) && is_finite(camera.up), "camera ",
            camera.name, ": origin, target or up is not finite");
  LTE_CHECK(camera.vfov > 0 && camera.vfov < 180, "camera ", camera.name,
            ": vfov must lie between 0 and 180 degrees, got ", camera.vfov);
  LTE_CHECK(is_finite(camera.direction(0.5f, 0.5f, 1)) &&
                length(camera.target - camera.origin) > 0 &&
                length(cross(camera.target - camera.origin, camera.up)) > 0,
            "camera ", camera.name,
            ": origin and target must differ, and up must not lie along the view");
}

/// Traces one row of primary rays in packets, which gain on coherent rays, and fills the row.
class GBufferTracer {
 public:
  GBufferTracer(const Bvh& bvh, const scene::Camera& camera, GBuffer* out)
      : bvh_(bvh),
        camera_(camera),
        out_(out),
        axis_(normalize(camera.target - camera.origin)),
        origin_(camera.origin - bvh.handles().origin),
        pixel_angle_(2 * std::tan(camera.vfov * kPi / 360) / static_cast<float>(out->height)) {}

  void trace_row(int y) const {
    for (int x = 0; x < out_->width; x += kPacket) trace_packet(x, y);
  }

 private:
  Vec3 direction(int x, int y) const {
    return camera_.direction((static_cast<float>(x) + 0.5f) / static_cast<float>(out_->width),
                             (static_cast<float>(y) + 0.5f) / static_cast<float>(out_->height),
                             static_cast<float>(out_->width) / static_cast<float>(out_->height));
  }

  void trace_packet(int x0, int y) const {
    const int count = std::min(kPacket, out_->width - x0);
    RTCRayHit8 packet;
    alignas(32) int valid[kPacket];
    for (int lane = 0; lane < kPacket; ++lane) {
      valid[lane] = lane < count ? -1 : 0;
      const Vec3 d = direction(std::min(x0 + lane, out_->width - 1), y);
      RTCRay8& ray = packet.ray;
      ray.org_x[lane] = origin_.x, ray.org_y[lane] = origin_.y, ray.org_z[lane] = origin_.z;
      ray.dir_x[lane] = d.x, ray.dir_y[lane] = d.y, ray.dir_z[lane] = d.z;
      ray.tnear[lane] = 0, ray.tfar[lane] = INFINITY, ray.time[lane] = 0;
      ray.mask[lane] = ~0u, ray.id[lane] = 0, ray.flags[lane] = 0;
      packet.hit.geomID[lane] = packet.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
    }
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    rtcIntersect8(valid, bvh_.handles().top, &context, &packet);
    for (int lane = 0; lane < count; ++lane) store(packet, lane, x0 + lane, y);
  }

  void store(const RTCRayHit8& packet, int lane, int x, int y) const {
    const auto i = static_cast<size_t>(y) * out_->width + x;
    const RTCHit8& hit = packet.hit;
    if (hit.geomID[lane] == RTC_INVALID_GEOMETRY_ID) {
      out_->depth[i] = INFINITY;
      return;
    }
    const auto instance = static_cast<int>(hit.instID[0][lane]);
    const InstanceRecord& record = bvh_.handles().instances[instance];
    const SurfacePoint point = surface_point(record, hit.primID[lane], hit.u[lane], hit.v[lane],
                                             {hit.Ng_x[lane], hit.Ng_y[lane], hit.Ng_z[lane]});
    const Vec3 d{packet.ray.dir_x[lane], packet.ray.dir_y[lane], packet.ray.dir_z[lane]};
    const float cos_front = -dot(point.normal, d);
    Rgb emission;
    scene::evaluate_appearance(bvh_.scene(), instance, hit.primID[lane], hit.u[lane], hit.v[lane],
                               packet.ray.tfar[lane] * pixel_angle_, &out_->albedo[i], &emission);
    out_->position[i] = point.position + bvh_.handles().origin;
    out_->normal[i] = cos_front >= 0 ? point.normal : -point.normal;
    out_->depth[i] = packet.ray.tfar[lane] * dot(d, axis_);
    out_->mask[i] = 1;
    if (record.emissive && (cos_front > 0 || record.two_sided)) out_->emission[i] = emission;
  }

  const Bvh& bvh_;
  const scene::Camera& camera_;
  GBuffer* out_;
  Vec3 axis_, origin_;
  float pixel_angle_;
};

struct PixelSum {
  double x = 0, y = 0, z = 0;
  void add(int, int, const Rgb& value) { x += value.x, y += value.y, z += value.z; }
  Rgb mean(int count) const {
    return {static_cast<float>(x / count), static_cast<float>(y / count),
            static_cast<float>(z / count)};
  }
};

}  // namespace

GBuffer trace_gbuffer(const Bvh& bvh, const scene::Camera& camera, int width, int height) {
  check_view(camera, width, height);
  GBuffer out;
  out.width = width;
  out.height = height;
  const auto pixels = static_cast<size_t>(width) * height;
  out.position.resize(pixels);
  out.normal.resize(pixels);
  out.albedo.resize(pixels);
  out.emission.resize(pixels);
  out.depth.resize(pixels);
  out.mask.resize(pixels);
  const GBufferTracer tracer(bvh, camera, &out);
  parallel_for(height, 4, [&](int64_t begin, int64_t end) {
    for (int64_t y = begin; y < end; ++y) tracer.trace_row(static_cast<int>(y));
  });
  return out;
}

image::Image render_reference(const Bvh& bvh, const Lights& lights, const scene::Camera& camera,
                              int width, int height, const RenderOptions& options) {
  check_view(camera, width, height);
  LTE_CHECK(&bvh.scene() == &lights.scene(), "the BVH and the lights are of two scenes");
  LTE_CHECK(options.spp >= 1, "spp must be at least 1, got ", options.spp);
  LTE_CHECK(options.max_depth >= 1, "max_depth must be at least 1, got ", options.max_depth);
  constexpr int kRouletteDepth = 4;  // that of irradiance, counted from the camera
  image::Image out(width, height, 3);
  if (lights.empty()) return out;
  const Vec3 origin = camera.origin - bvh.handles().origin;
  const float aspect = static_cast<float>(width) / static_cast<float>(height);
  parallel_for(height, 1, [&](int64_t begin, int64_t end) {
    NoRecorder none;
    Transport transport(bvh, lights, options.max_depth, kRouletteDepth, none);
    for (int64_t pixel = begin * width; pixel < end * width; ++pixel) {
      const auto x = static_cast<int>(pixel % width), y = static_cast<int>(pixel / width);
      PathSampler sampler(Sampling::Sobol, options.seed, static_cast<uint64_t>(pixel));
      sampler.start_set(options.spp);
      PixelSum sum;
      for (int i = 0; i < options.spp; ++i) {
        sampler.next_path();
        const Vec2 jitter = sampler.direction(0);
        const Vec3 direction = camera.direction(
            (static_cast<float>(x) + jitter.x) / static_cast<float>(width),
            (static_cast<float>(y) + jitter.y) / static_cast<float>(height), aspect);
        transport.follow(PathState{origin, direction, {}}, sampler, sum);
      }
      out.set_rgb(x, y, sum.mean(options.spp));
    }
  });
  return out;
}

}  // namespace lte::pathtrace
