#include "lte/pathtrace/blocks/ray_packets.h"

#include <algorithm>
#include <cmath>

#include "lte/pathtrace/embree_scene.h"

namespace lte::pathtrace {
namespace {

/// Lanes first ... first + N - 1 of a block; arrays are as long as the block, so those beyond
/// `count` can be read, and stay off.
template <int N, typename Rays>
void fill(const Lanes3& origin, const Lanes3& direction, int first, int count, Rays* rays,
          int* valid) {
  std::copy_n(origin.x + first, N, rays->org_x);
  std::copy_n(origin.y + first, N, rays->org_y);
  std::copy_n(origin.z + first, N, rays->org_z);
  std::copy_n(direction.x + first, N, rays->dir_x);
  std::copy_n(direction.y + first, N, rays->dir_y);
  std::copy_n(direction.z + first, N, rays->dir_z);
  for (int lane = 0; lane < N; ++lane) valid[lane] = first + lane < count ? -1 : 0;
}

template <int N>
void intersect_packets(RTCScene top, const Lanes3& origin, const Lanes3& direction, int count,
                       HitBlock* hits) {
  typename Packet<N>::Hits packet;
  alignas(64) int valid[N];
  set_constants(&packet.ray);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  for (int first = 0; first < count; first += N) {
    fill<N>(origin, direction, first, count, &packet.ray, valid);
    std::fill_n(packet.ray.tfar, N, INFINITY);
    std::fill_n(packet.hit.geomID, N, RTC_INVALID_GEOMETRY_ID);
    std::fill_n(packet.hit.instID[0], N, RTC_INVALID_GEOMETRY_ID);
    Packet<N>::kIntersect(valid, top, &context, &packet);
    for (int lane = 0; lane < N; ++lane) {  // kNone is all ones too
      hits->instance[first + lane] =
          static_cast<int32_t>(instance_of(packet.hit.instID[0][lane], packet.hit.geomID[lane]));
    }
    std::copy_n(packet.hit.primID, N, hits->triangle + first);
    std::copy_n(packet.ray.tfar, N, hits->t + first);
    std::copy_n(packet.hit.u, N, hits->u + first);
    std::copy_n(packet.hit.v, N, hits->v + first);
    std::copy_n(packet.hit.Ng_x, N, hits->normal.x + first);
    std::copy_n(packet.hit.Ng_y, N, hits->normal.y + first);
    std::copy_n(packet.hit.Ng_z, N, hits->normal.z + first);
  }
}

template <int N>
void occlude_packets(RTCScene top, const ShadowBlock& shadows, int32_t* stopped) {
  typename Packet<N>::Rays packet;
  alignas(64) int valid[N];
  set_constants(&packet);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  for (int first = 0; first < shadows.size; first += N) {
    fill<N>(shadows.origin, shadows.direction, first, shadows.size, &packet, valid);
    std::copy_n(shadows.t_max + first, N, packet.tfar);
    Packet<N>::kOccluded(valid, top, &context, &packet);
    // Embree's sign for occluded.
    for (int lane = 0; lane < N; ++lane) stopped[first + lane] = packet.tfar[lane] < 0 ? 1 : 0;
  }
}

}  // namespace

int native_packet_width(RTCDevice device) {
  if (rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED) != 0) return 16;
  if (rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED) != 0) return 8;
  return 4;
}

void intersect(RTCScene top, int packet_width, const Lanes3& origin, const Lanes3& direction,
               int count, HitBlock* hits) {
  switch (packet_width) {
    case 16:
      return intersect_packets<16>(top, origin, direction, count, hits);
    case 8:
      return intersect_packets<8>(top, origin, direction, count, hits);
    default:
      return intersect_packets<4>(top, origin, direction, count, hits);
  }
}

void occluded(RTCScene top, int packet_width, const ShadowBlock& rays, int32_t* stopped) {
  switch (packet_width) {
    case 16:
      return occlude_packets<16>(top, rays, stopped);
    case 8:
      return occlude_packets<8>(top, rays, stopped);
    default:
      return occlude_packets<4>(top, rays, stopped);
  }
}

}  // namespace lte::pathtrace
