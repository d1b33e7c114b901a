#include "lte/embed/point_count.h"

#include <algorithm>
#include <vector>

#include "lte/base/parallel_each.h"
#include "lte/base/random.h"
#include "lte/pathtrace/hemisphere.h"
#include "lte/pathtrace/ray_offset.h"
#include "lte/pathtrace/reach/reach.h"
#include "lte/scene/sampler.h"

namespace lte::embed {
namespace {

constexpr int64_t kProbes = 256;
constexpr int kRays = 16;  ///< from a side of a point
constexpr int64_t kGrain = 16;
constexpr uint64_t kPlaces = 81, kRaysOfPlace = 82;
/// Rooms with little in them have less than the first, several furnished ones more than the second.
constexpr double kPlain = 150, kRich = 425;
/// Rays need so many times fewer, in rich scenes half as many times.
constexpr int64_t kRaysNeedFewer = 8;
// As long as that is no more than in training.
constexpr int64_t kMin = 1024, kPointsOfLuminaire = 16;

/// One over the harmonic mean of the distances that one sees from a side of a point; the sky is
/// infinitely far.
double nearness(const pathtrace::Bvh& bvh, const Vec3& position, const Vec3& side, Rng* rng) {
  const Vec3 origin =
      pathtrace::offset_origin(position, side, 0.5f * max_component(bvh.bounds().extent()));
  double sum = 0;
  for (int ray = 0; ray < kRays; ++ray) {
    float density = 0;
    const Vec2 u{(static_cast<float>(ray) + rng->uniform()) / kRays, rng->uniform()};
    const pathtrace::Hit hit =
        bvh.intersect({origin, pathtrace::cosine_direction(side, u, &density)});
    if (hit.valid() && hit.t > 0) sum += 1 / double{hit.t};
  }
  return sum / kRays;
}

/// Of the more open side that sees anything.
double nearness(const pathtrace::Bvh& bvh, const scene::SurfaceSamples& points, size_t i) {
  Rng rng(kRaysOfPlace, i);
  const double front = nearness(bvh, points.position[i], points.normal[i], &rng),
               back = nearness(bvh, points.position[i], -points.normal[i], &rng);
  return front > 0 && back > 0 ? std::min(front, back) : std::max(front, back);
}

}  // namespace

double surface_detail(const pathtrace::Bvh& bvh) {
  scene::SamplerOptions sampler;
  sampler.seed = kPlaces;
  sampler.environment_share = 0;
  sampler.punctual_lights = false;
  const scene::SurfaceSamples points = scene::sample_surface(bvh.scene(), kProbes, sampler);
  const std::vector<uint8_t> reached =
      pathtrace::reached(bvh, points.position, points.normal, pathtrace::Sides::Either, {});
  std::vector<double> near;
  double area = 0;
  std::vector<double> of_point(reached.size());
  parallel_each(reached.size(), kGrain, [&](size_t i) {
    if (reached[i] != 0) of_point[i] = nearness(bvh, points, i);
  });
  for (size_t i = 0; i < reached.size(); ++i) {
    if (reached[i] == 0) continue;
    near.push_back(of_point[i]);
    area += double{points.area[i]};
  }
  if (near.empty()) return 0;
  const auto middle = near.begin() + static_cast<std::ptrdiff_t>(near.size() / 2);
  std::nth_element(near.begin(), middle, near.end());
  return area * *middle * *middle;
}

int64_t scene_point_count(const pathtrace::Bvh& bvh, int64_t trained, Reader reader) {
  const double detail = surface_detail(bvh);
  int64_t count = detail < kPlain ? trained / 2 : trained;
  if (reader == Reader::Rays) count /= detail > kRich ? kRaysNeedFewer / 2 : kRaysNeedFewer;
  const auto luminaires = static_cast<int64_t>(bvh.scene().light_groups.size());
  return std::max(count, std::min(trained, std::max(kMin, kPointsOfLuminaire * luminaires)));
}

}  // namespace lte::embed
