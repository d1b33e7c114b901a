#include "lte/pathtrace/reach/reach.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "lte/base/check.h"
#include "lte/pathtrace/reach/reach_memory.h"
#include "lte/pathtrace/reach/reach_samples.h"
#include "lte/pathtrace/reach/reach_search.h"
#include "lte/pathtrace/transport/irradiance_kernel.h"
#include "lte/scene/light_points.h"

namespace lte::pathtrace {
namespace {

constexpr double kMaxOversampling = 8;
constexpr int64_t kProbePoints = 256;  // they estimate the reached share of the surface

void check_search(std::span<const Vec3> positions, std::span<const Vec3> normals,
                  const ReachOptions& options) {
  IrradianceOptions check;
  check.max_depth = options.max_depth;
  check_points(positions, normals);
  check_irradiance_options(check);
}

/// Indices of the samples to keep.
KeptSamples kept_samples(const Bvh& bvh, const scene::SurfaceSamples& samples, Sides sides,
                         const ReachOptions& options, const ReachRecall& recall) {
  check_search(samples.position, samples.normal, options);
  const std::vector<uint8_t> keep =
      search_for_light(bvh, samples.position, samples.normal, sides, options, recall);
  KeptSamples kept;
  for (size_t i = 0; i < keep.size(); ++i) {
    const bool emits = sides == Sides::Either && samples.light_group[i] != scene::kNone;
    if (emits) {
      kept.luminaires.push_back(i);
    } else if (keep[i]) {
      kept.others.push_back(i);
    }
  }
  return kept;
}

/// sample_reached_surface() without the lights that are no surface.
scene::SurfaceSamples sample_surfaces(const Bvh& bvh, int64_t count,
                                      const scene::SamplerOptions& sampler, Sides sides,
                                      const ReachOptions& options, const ReachRecall& recall,
                                      PruneCounts* counts) {
  scene::SamplerOptions plain = sampler;
  plain.emissive_share = 0;
  const scene::SurfaceSamples probe = scene::sample_surface(bvh.scene(), kProbePoints, plain);
  const auto found = static_cast<double>(kept_samples(bvh, probe, sides, options, recall).size());
  const double share = std::max(1.0, found) / kProbePoints;
  // Draws three standard errors of the share more than it asks for.
  const double error = std::sqrt((1 - share) / (share * kProbePoints));
  double oversampling = (1 + 3 * error) / share;
  for (;;) {
    oversampling = std::min(oversampling, kMaxOversampling);
    const auto drawn = static_cast<int64_t>(std::ceil(static_cast<double>(count) * oversampling));
    scene::SurfaceSamples samples = scene::sample_surface(bvh.scene(), drawn, sampler);
    KeptSamples kept = kept_samples(bvh, samples, sides, options, recall);
    const int64_t left = kept.size();
    if (left < count && oversampling < kMaxOversampling) {
      oversampling *=
          1.05 * static_cast<double>(count) / static_cast<double>(std::max<int64_t>(1, left));
      continue;
    }
    if (left == 0) return scene::sample_surface(bvh.scene(), count, sampler);
    counts->drawn = drawn;
    counts->pruned = drawn - left;
    reduce_samples(bvh.scene(), std::move(kept), count, &samples);
    return samples;
  }
}

}  // namespace

std::vector<uint8_t> reached(const Bvh& bvh, std::span<const Vec3> positions,
                             std::span<const Vec3> normals, Sides sides,
                             const ReachOptions& options) {
  check_search(positions, normals, options);
  return search_for_light(bvh, positions, normals, sides, options, ReachRecall{});
}

scene::SurfaceSamples sample_reached_surface(const Bvh& bvh, int64_t count,
                                             const scene::SamplerOptions& sampler, Sides sides,
                                             const ReachOptions& options, PruneCounts* counts) {
  return sample_reached_surface(bvh, count, sampler, sides, options, ReachRecall{}, counts);
}

scene::SurfaceSamples sample_reached_surface(const Bvh& bvh, int64_t count,
                                             const scene::SamplerOptions& sampler, Sides sides,
                                             const ReachOptions& options, const ReachRecall& recall,
                                             PruneCounts* counts) {
  LTE_CHECK(recall.rounds >= 1 && recall.rounds <= kReachRounds,
            "rounds of the search for light: expected 1 to ", kReachRounds, ", got ",
            recall.rounds);
  // Lights that are no surface are neither reached nor missed: they are added at the end.
  const scene::Scene& scene = bvh.scene();
  scene::SamplerOptions surfaces = sampler;
  surfaces.environment_share = 0;
  surfaces.punctual_lights = false;
  scene::SurfaceSamples samples =
      sample_surfaces(bvh, scene::surface_point_count(scene, count, sampler), surfaces, sides,
                      options, recall, counts);
  const double area = std::accumulate(samples.area.begin(), samples.area.end(), 0.0);
  scene::append_light_points(scene, count,
                             static_cast<float>(area / static_cast<double>(samples.size())),
                             sampler, &samples);
  return samples;
}

}  // namespace lte::pathtrace
