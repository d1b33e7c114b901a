#include "experiments/replay/ray_replay.h"

#include <algorithm>
#include <atomic>
#include <numeric>

#include "lte/base/parallel.h"
#include "lte/pathtrace/blocks/ray_packets.h"
#include "lte/pathtrace/embree_scene.h"

namespace lte::experiments {
namespace {

using pathtrace::Packet;

/// Rays a stream call takes: enough to be sorted by Embree, few enough to stay in the cache.
constexpr size_t kStream = 256;

Vec3 vector_at(const std::vector<float>* components, size_t i) {
  return {components[0][i], components[1][i], components[2][i]};
}

int64_t trace_singly(RTCScene top, const RayLog& log) {
  int64_t found = 0;
  for (size_t i = 0; i < log.nearest_rays.size(); ++i) {
    RTCRayHit hit;
    found += pathtrace::intersect(top, vector_at(log.nearest_rays.origin, i),
                                  vector_at(log.nearest_rays.direction, i), &hit)
                 ? 1
                 : 0;
  }
  for (size_t i = 0; i < log.shadow_rays.size(); ++i) {
    found += pathtrace::occluded(top, vector_at(log.shadow_rays.origin, i),
                                 vector_at(log.shadow_rays.direction, i), log.shadow_rays.t_max[i])
                 ? 1
                 : 0;
  }
  return found;
}

/// Rays first ... first + N - 1 of `rays`; lanes beyond their end repeat the last and stay off.
template <int N, typename Rays>
void fill(const RayArrays& rays, size_t first, Rays* out, int* valid) {
  const size_t last = rays.size() - 1;
  const auto copy = [&](const std::vector<float>& from, float* to) {
    if (first + N <= rays.size()) {
      std::copy_n(from.data() + first, N, to);
    } else {
      for (size_t lane = 0; lane < N; ++lane) to[lane] = from[std::min(first + lane, last)];
    }
  };
  copy(rays.origin[0], out->org_x);
  copy(rays.origin[1], out->org_y);
  copy(rays.origin[2], out->org_z);
  copy(rays.direction[0], out->dir_x);
  copy(rays.direction[1], out->dir_y);
  copy(rays.direction[2], out->dir_z);
  copy(rays.t_max, out->tfar);
  for (size_t lane = 0; lane < N; ++lane) valid[lane] = first + lane <= last ? -1 : 0;
}

template <int N>
int64_t trace_packets(RTCScene top, const RayLog& log) {
  int64_t found = 0;
  alignas(64) int valid[N];
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  typename Packet<N>::Hits packet;
  pathtrace::set_constants(&packet.ray);
  for (size_t i = 0; i < log.nearest_rays.size(); i += N) {
    fill<N>(log.nearest_rays, i, &packet.ray, valid);
    for (int lane = 0; lane < N; ++lane)
      packet.hit.geomID[lane] = packet.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
    Packet<N>::kIntersect(valid, top, &context, &packet);
    for (int lane = 0; lane < N; ++lane)
      found += valid[lane] && packet.hit.geomID[lane] != RTC_INVALID_GEOMETRY_ID ? 1 : 0;
  }
  typename Packet<N>::Rays shadows;
  pathtrace::set_constants(&shadows);
  for (size_t i = 0; i < log.shadow_rays.size(); i += N) {
    fill<N>(log.shadow_rays, i, &shadows, valid);
    Packet<N>::kOccluded(valid, top, &context, &shadows);
    for (int lane = 0; lane < N; ++lane) found += valid[lane] && shadows.tfar[lane] < 0 ? 1 : 0;
  }
  return found;
}

int64_t trace_streams(RTCScene top, const RayLog& log) {
  int64_t found = 0;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  std::vector<RTCRayHit> hits(kStream);
  std::vector<RTCRay> rays(kStream);
  for (size_t first = 0; first < log.nearest_rays.size(); first += kStream) {
    const size_t count = std::min(kStream, log.nearest_rays.size() - first);
    for (size_t i = 0; i < count; ++i) {
      pathtrace::set_ray(&hits[i].ray, vector_at(log.nearest_rays.origin, first + i),
                         vector_at(log.nearest_rays.direction, first + i), 0, INFINITY);
      hits[i].hit.geomID = hits[i].hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    }
    rtcIntersect1M(top, &context, hits.data(), static_cast<unsigned>(count), sizeof(RTCRayHit));
    for (size_t i = 0; i < count; ++i)
      found += hits[i].hit.geomID != RTC_INVALID_GEOMETRY_ID ? 1 : 0;
  }
  for (size_t first = 0; first < log.shadow_rays.size(); first += kStream) {
    const size_t count = std::min(kStream, log.shadow_rays.size() - first);
    for (size_t i = 0; i < count; ++i) {
      pathtrace::set_ray(&rays[i], vector_at(log.shadow_rays.origin, first + i),
                         vector_at(log.shadow_rays.direction, first + i), 0,
                         log.shadow_rays.t_max[first + i]);
    }
    rtcOccluded1M(top, &context, rays.data(), static_cast<unsigned>(count), sizeof(RTCRay));
    for (size_t i = 0; i < count; ++i) found += rays[i].tfar < 0 ? 1 : 0;
  }
  return found;
}

int64_t trace(RTCScene top, const RayLog& log, EntryPoint entry) {
  switch (entry) {
    case EntryPoint::One:
      return trace_singly(top, log);
    case EntryPoint::Packet4:
      return trace_packets<4>(top, log);
    case EntryPoint::Packet8:
      return trace_packets<8>(top, log);
    case EntryPoint::Packet16:
      return trace_packets<16>(top, log);
    case EntryPoint::Stream:
      return trace_streams(top, log);
  }
  return 0;
}

/// 7 bits an axis of each of two vectors in [0, 1]³, under 3 bits of octant.
uint64_t coherence_key(const Vec3& place, const Vec3& direction) {
  const auto spread = [](const Vec3& p) {
    uint64_t code = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const auto cell = static_cast<uint64_t>(std::clamp(p[axis] * 128, 0.0f, 127.0f));
      for (int bit = 0; bit < 7; ++bit) code |= ((cell >> bit) & 1) << (3 * bit + axis);
    }
    return code;
  };
  const uint64_t octant =
      (direction.x < 0 ? 1u : 0u) | (direction.y < 0 ? 2u : 0u) | (direction.z < 0 ? 4u : 0u);
  return (octant << 42) | (spread(place) << 21) | spread((direction + Vec3{1, 1, 1}) * 0.5f);
}

void sort_rays(const Vec3& low, float scale, RayArrays* rays) {
  std::vector<std::pair<uint64_t, uint32_t>> order(rays->size());
  for (size_t i = 0; i < order.size(); ++i) {
    const Vec3 place = (vector_at(rays->origin, i) - low) * scale;
    order[i] = {coherence_key(place, vector_at(rays->direction, i)), static_cast<uint32_t>(i)};
  }
  std::sort(order.begin(), order.end());
  RayArrays sorted;
  for (const auto& [key, i] : order)
    sorted.add(vector_at(rays->origin, i), vector_at(rays->direction, i), rays->t_max[i]);
  *rays = std::move(sorted);
}

}  // namespace

void RayArrays::add(const Vec3& o, const Vec3& d, float t) {
  for (int axis = 0; axis < 3; ++axis) {
    origin[axis].push_back(o[axis]);
    direction[axis].push_back(d[axis]);
  }
  t_max.push_back(t);
}

void RayRecorder::nearest(int, const pathtrace::PathBlock& rays) {
  for (int lane = 0; lane < rays.size; ++lane)
    log->nearest_rays.add(rays.origin.at(lane), rays.direction.at(lane), INFINITY);
}

void RayRecorder::shadow(const pathtrace::ShadowBlock& rays) {
  for (int lane = 0; lane < rays.size; ++lane)
    log->shadow_rays.add(rays.origin.at(lane), rays.direction.at(lane), rays.t_max[lane]);
}

std::string name_of(EntryPoint entry) {
  switch (entry) {
    case EntryPoint::One:
      return "rtcIntersect1";
    case EntryPoint::Packet4:
      return "rtcIntersect4";
    case EntryPoint::Packet8:
      return "rtcIntersect8";
    case EntryPoint::Packet16:
      return "rtcIntersect16";
    case EntryPoint::Stream:
      return "rtcIntersect1M";
  }
  return {};
}

int64_t replay(const pathtrace::Bvh& bvh, const std::vector<RayLog>& logs, EntryPoint entry) {
  std::atomic<int64_t> hits{0};
  parallel_for(static_cast<int64_t>(logs.size()), 4, [&](int64_t begin, int64_t end) {
    int64_t found = 0;
    for (int64_t i = begin; i < end; ++i)
      found += trace(bvh.handles().top, logs[static_cast<size_t>(i)], entry);
    hits += found;
  });
  return hits;
}

void sort_rays(const Bounds& bounds, std::vector<RayLog>* logs) {
  const Vec3 low = bounds.low - pathtrace::frame_origin(bounds);
  const float scale = 1 / std::max(max_component(bounds.extent()), 1e-30f);
  for (RayLog& log : *logs) {
    sort_rays(low, scale, &log.nearest_rays);
    sort_rays(low, scale, &log.shadow_rays);
  }
}

}  // namespace lte::experiments
