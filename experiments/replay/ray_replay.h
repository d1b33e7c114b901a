// Rays of the path tracer, recorded and handed to Embree through each of its entry points and
// nothing else: what the path tracer is compared with.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lte/base/math.h"
#include "lte/pathtrace/blocks/path_block.h"
#include "lte/pathtrace/bvh.h"

namespace lte::experiments {

/// Rays by component, as packets are filled from them.
struct RayArrays {
  std::vector<float> origin[3], direction[3];
  std::vector<float> t_max;

  size_t size() const { return t_max.size(); }
  void add(const Vec3& o, const Vec3& d, float t);
};

/// The rays of one query point, nearest hits and shadows apart.
struct RayLog {
  RayArrays nearest_rays, shadow_rays;
};

/// An observer of pathtrace::BasicTransport that appends its rays to a log.
struct RayRecorder {
  void nearest(int depth, const pathtrace::PathBlock& rays);
  void shadow(const pathtrace::ShadowBlock& rays);

  RayLog* log = nullptr;
};

/// How Embree is asked.
enum class EntryPoint { One, Packet4, Packet8, Packet16, Stream };
inline constexpr EntryPoint kRecordPoints[] = {EntryPoint::One, EntryPoint::Packet4,
                                               EntryPoint::Packet8, EntryPoint::Packet16,
                                               EntryPoint::Stream};

/// E.g. "rtcIntersect8".
std::string name_of(EntryPoint entry);

/// Traces all rays of the logs on num_threads() threads, log by log: its nearest rays, then its
/// shadow rays, in their order.
/// @return  how many were stopped by a surface
int64_t replay(const pathtrace::Bvh& bvh, const std::vector<RayLog>& logs, EntryPoint entry);

/// Reorders each log's rays by the octant of their direction, then along the Morton curve of their
/// origins and, among equal ones, of their directions: what makes rays side by side coherent.
void sort_rays(const Bounds& bounds, std::vector<RayLog>* logs);

}  // namespace lte::experiments
