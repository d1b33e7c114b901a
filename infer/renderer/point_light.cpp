#include "infer/renderer/point_light.h"

#include <numeric>
#include <utility>

#include "lte/base/timer.h"
#include "lte/gi/gather.h"
#include "lte/pathtrace/direct_light.h"

namespace lte::infer {

void LitPoints::reserve(size_t count) {
  position.reserve(count);
  normal.reserve(count);
  pixel.reserve(count);
}

LitPoints LitPoints::some(std::span<const size_t> which) const {
  LitPoints out;
  out.reserve(which.size());
  for (const size_t i : which) {
    out.position.push_back(position[i]);
    out.normal.push_back(normal[i]);
    out.pixel.push_back(pixel[i]);
  }
  return out;
}

PointLight light_points(const GatherScene& scene, const LitPoints& points, const LightRays& rays,
                        int64_t first_index, LightWork* work) {
  work->points += static_cast<int64_t>(points.size());
  PointLight out;
  Timer timer;
  std::vector<Rgb> met;
  if (rays.gather > 0 && scene.max_depth < 2) {
    out.indirect.resize(points.size());
  } else if (rays.gather > 0) {
    gi::GatherOptions options;
    options.rays = rays.gather;
    options.max_depth = scene.max_depth;
    options.seed = scene.seed;
    gi::Gathered gathered = gi::gather_irradiance(
        scene.bvh, scene.lights, scene.table, points.position, points.normal, options, first_index);
    out.indirect = std::move(gathered.indirect);
    met = std::move(gathered.met);
  }
  work->gather_seconds += timer.seconds();
  if (rays.shadow == 0) return out;
  timer.restart();
  std::vector<uint64_t> streams(points.size());
  std::iota(streams.begin(), streams.end(), static_cast<uint64_t>(first_index));
  pathtrace::DirectOptions options;
  options.seed = scene.seed;
  // As many rays over the hemisphere as shadow rays have been traced already.
  const bool both = !met.empty() && rays.gather == rays.shadow;
  if (both) {
    options.hemisphere_share = 1;
    options.hemisphere_elsewhere = true;
  }
  out.direct = std::move(
      pathtrace::estimate_direct(scene.bvh, scene.lights, {points.position, points.normal, streams},
                                 std::vector<int32_t>(points.size(), rays.shadow), options)
          .irradiance);
  for (size_t i = 0; both && i < met.size(); ++i) out.direct[i] += met[i];
  work->direct_seconds += timer.seconds();
  return out;
}

}  // namespace lte::infer
