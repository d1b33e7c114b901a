// Internal: a block of rays through Embree, in the widest packets that it has code for on this
// machine. Packets beat single rays even where rays are incoherent (docs/benchmarks.md).
#pragma once

#include <cstdint>

#include <embree3/rtcore.h>

#include "lte/pathtrace/blocks/path_block.h"

namespace lte::pathtrace {

/// 16, 8 or 4.
int native_packet_width(RTCDevice device);

/// Nearest hits of `count` rays.
void intersect(RTCScene top, int packet_width, const Lanes3& origin, const Lanes3& direction,
               int count, HitBlock* hits);

/// @param stopped  [rays.size] 1 where a surface lies nearer than t_max, 0 elsewhere
void occluded(RTCScene top, int packet_width, const ShadowBlock& rays, int32_t* stopped);

/// rtcIntersectN, rtcOccludedN and what they take, by width.
template <int N>
struct Packet;

#define LTE_PACKET(N)                                   \
  template <>                                           \
  struct Packet<N> {                                    \
    using Hits = RTCRayHit##N;                          \
    using Rays = RTCRay##N;                             \
    static constexpr auto kIntersect = rtcIntersect##N; \
    static constexpr auto kOccluded = rtcOccluded##N;   \
  }
LTE_PACKET(4);
LTE_PACKET(8);
LTE_PACKET(16);
#undef LTE_PACKET

/// What is the same for every ray.
template <typename Rays>
void set_constants(Rays* rays) {
  for (float& t : rays->tnear) t = 0;
  for (float& t : rays->time) t = 0;
  for (unsigned& mask : rays->mask) mask = ~0u;
  for (unsigned& id : rays->id) id = 0;
  for (unsigned& flags : rays->flags) flags = 0;
}

}  // namespace lte::pathtrace
