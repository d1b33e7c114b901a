#include "infer/renderer/point_light.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "lte/base/parallel.h"
#include "lte/base/random.h"
#include "lte/base/timer.h"
#include "lte/gi/gather.h"
#include "lte/pathtrace/direct_light.h"

namespace lte::infer {
namespace {

/// A cell that so many times the rays of a point know of gets no more.
constexpr float kEnough = 4;
/// The part of the rays that others get.
constexpr int kRefine = 4;
constexpr int64_t kGrain = 4096;

PointLight sample(const GatherScene& scene, const LitPoints& points, const LightRays& rays,
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

/// How many times the wanted rays know of a cell.
float known_share(const gi::CellLight& light, const LightRays& rays) {
  float share = std::numeric_limits<float>::infinity();
  if (rays.gather > 0) share = light.indirect_rays / static_cast<float>(rays.gather);
  if (rays.shadow > 0) share = std::min(share, light.direct_rays / static_cast<float>(rays.shadow));
  return share;
}

void put(const PointLight& light, const LightRays& rays, std::span<const size_t> which,
         std::vector<gi::CellLight>* out) {
  for (size_t k = 0; k < which.size(); ++k) {
    gi::CellLight& found = (*out)[which[k]];
    if (rays.gather > 0) {
      found.indirect = light.indirect[k];
      found.indirect_rays = static_cast<float>(rays.gather);
    }
    if (rays.shadow > 0) {
      found.direct = light.direct[k];
      found.direct_rays = static_cast<float>(rays.shadow);
    }
  }
}

/// Estimates where cells know too little, and adds them to the cells.
PointLight light_with_cells(const GatherScene& scene, const LitPoints& points,
                            const LightRays& rays, int64_t first_index, LightWork* work) {
  std::vector<gi::CellLight> known(points.size()), found(points.size());
  parallel_for(static_cast<int64_t>(points.size()), kGrain, [&](int64_t begin, int64_t end) {
    for (auto i = static_cast<size_t>(begin); i < static_cast<size_t>(end); ++i) {
      const gi::CellLight* light =
          scene.cells->find(points.position[i], points.normal[i], points.extent[i]);
      if (light != nullptr) known[i] = *light;
    }
  });
  std::vector<size_t> fresh, few;
  for (size_t i = 0; i < points.size(); ++i) {
    const float share = known_share(known[i], rays);
    if (share < 1) {
      fresh.push_back(i);
    } else if (share < kEnough) {
      few.push_back(i);
    }
  }
  GatherScene now = scene;
  if (scene.view > 0) now.seed = hash_combine(scene.seed, static_cast<uint64_t>(scene.view));
  put(sample(now, points.some(fresh), rays, first_index, work), rays, fresh, &found);
  const auto part = [](int count) { return count > 0 ? std::max(1, count / kRefine) : 0; };
  const LightRays less{part(rays.gather), part(rays.shadow)};
  put(sample(now, points.some(few), less, first_index + static_cast<int64_t>(fresh.size()), work),
      less, few, &found);
  PointLight out;
  if (rays.gather > 0) out.indirect.resize(points.size());
  if (rays.shadow > 0) out.direct.resize(points.size());
  for (size_t i = 0; i < points.size(); ++i) {
    scene.cells->add(points.position[i], points.normal[i], points.extent[i], found[i]);
    known[i].add(found[i]);
    if (rays.gather > 0) out.indirect[i] = known[i].indirect;
    if (rays.shadow > 0) out.direct[i] = known[i].direct;
  }
  return out;
}

}  // namespace

void LitPoints::reserve(size_t count) {
  position.reserve(count);
  normal.reserve(count);
  extent.reserve(count);
  pixel.reserve(count);
}

LitPoints LitPoints::some(std::span<const size_t> which) const {
  LitPoints out;
  out.reserve(which.size());
  for (const size_t i : which) {
    out.position.push_back(position[i]);
    out.normal.push_back(normal[i]);
    out.extent.push_back(extent[i]);
    out.pixel.push_back(pixel[i]);
  }
  return out;
}

PointLight light_points(const GatherScene& scene, const LitPoints& points, const LightRays& rays,
                        int64_t first_index, LightWork* work) {
  return scene.cells == nullptr ? sample(scene, points, rays, first_index, work)
                                : light_with_cells(scene, points, rays, first_index, work);
}

}  // namespace lte::infer
