#include "lte/pathtrace/render.h"

#include <array>
#include <cmath>
#include <memory>
#include <numeric>
#include <vector>

#include "lte/base/check.h"
#include "lte/base/parallel.h"
#include "lte/pathtrace/transport/path_sampler.h"
#include "lte/pathtrace/transport/transport.h"
#include "lte/scene/number_check.h"
#include "lte/scene/surface.h"

namespace lte::pathtrace {
namespace {

constexpr int kPacket = 8;

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
      ray.org_x[lane] = origin_.x;
      ray.org_y[lane] = origin_.y;
      ray.org_z[lane] = origin_.z;
      ray.dir_x[lane] = d.x;
      ray.dir_y[lane] = d.y;
      ray.dir_z[lane] = d.z;
      ray.tnear[lane] = 0;
      ray.tfar[lane] = INFINITY;
      ray.time[lane] = 0;
      ray.mask[lane] = ~0u;
      ray.id[lane] = 0;
      ray.flags[lane] = 0;
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
      if (bvh_.scene().environment) {
        out_->emission[i] = bvh_.scene().environment->radiance_from(
            {packet.ray.dir_x[lane], packet.ray.dir_y[lane], packet.ray.dir_z[lane]});
      }
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

/// Traces one row of pixels, in blocks that may hold several pixels or a part of one.
class RowTracer : public LightSink {
 public:
  RowTracer(const Bvh& bvh, const Lights& lights, const scene::Camera& camera,
            const RenderOptions& options, image::Image* out)
      : camera_(camera),
        options_(options),
        out_(out),
        origin_(camera.origin - bvh.handles().origin),
        sampler_(Sampling::Sobol, options.spp),
        transport_(bvh, lights, options.max_depth, kRouletteDepth, *this),
        sums_(static_cast<size_t>(out->width)) {}

  void trace_row(int y) {
    std::fill(sums_.begin(), sums_.end(), Sum{});
    for (int x = 0; x < out_->width; ++x) {
      const auto pixel =
          static_cast<uint64_t>(y) * static_cast<uint64_t>(out_->width) + static_cast<uint64_t>(x);
      sampler_.start_stream(options_.seed, pixel);
      sampler_.start_set();
      for (int i = 0; i < options_.spp; ++i) {
        if (sampler_.paths() == kBlock) flush(y);
        pixel_[static_cast<size_t>(sampler_.paths())] = x;
        sampler_.add_path();
      }
    }
    flush(y);
    for (int x = 0; x < out_->width; ++x) {
      const Sum& sum = sums_[static_cast<size_t>(x)];
      const double count = options_.spp;
      out_->set_rgb(x, y,
                    {static_cast<float>(sum.x / count), static_cast<float>(sum.y / count),
                     static_cast<float>(sum.z / count)});
    }
  }

  void add(int, std::span<const Contribution> contributions) override {
    for (const Contribution& c : contributions) {
      Sum& sum = sums_[static_cast<size_t>(pixel_[static_cast<size_t>(c.path)])];
      sum.x += c.value.x;
      sum.y += c.value.y;
      sum.z += c.value.z;
    }
  }

 private:
  static constexpr int kRouletteDepth = 4;  // that of irradiance, counted from the camera
  struct Sum {
    double x = 0, y = 0, z = 0;
  };

  void flush(int y) {
    const int count = sampler_.paths();
    std::array<int32_t, kBlock> all;
    std::iota(all.begin(), all.end(), 0);
    sampler_.direction(0, all.data(), count, &jitter_);
    const auto width = static_cast<float>(out_->width), height = static_cast<float>(out_->height);
    for (int lane = 0; lane < count; ++lane) {
      const auto x = static_cast<float>(pixel_[static_cast<size_t>(lane)]);
      transport_.start().origin.put(lane, origin_);
      transport_.start().direction.put(
          lane, camera_.direction((x + to_unit(jitter_.x[lane])) / width,
                                  (static_cast<float>(y) + to_unit(jitter_.y[lane])) / height,
                                  width / height));
    }
    transport_.trace_from_camera(sampler_);
    sampler_.clear();
  }

  const scene::Camera& camera_;
  const RenderOptions& options_;
  image::Image* out_;
  const Vec3 origin_;
  PathSampler sampler_;
  Transport transport_;
  DirectionNumbers jitter_;
  std::array<int32_t, kBlock> pixel_;
  std::vector<Sum> sums_;
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
  image::Image out(width, height, 3);
  if (lights.empty()) return out;
  parallel_for(height, 1, [&](int64_t begin, int64_t end) {
    const auto tracer = std::make_unique<RowTracer>(bvh, lights, camera, options, &out);
    for (int64_t y = begin; y < end; ++y) tracer->trace_row(static_cast<int>(y));
  });
  return out;
}

}  // namespace lte::pathtrace
