#include "lte/pathtrace/reach/reach.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "lte/base/check.h"
#include "lte/base/random.h"
#include "lte/pathtrace/reach/orientation.h"
#include "lte/pathtrace/reach/reach_memory.h"
#include "lte/pathtrace/reach/reach_samples.h"
#include "lte/pathtrace/reach/reach_search.h"
#include "lte/pathtrace/transport/irradiance_kernel.h"
#include "lte/scene/light_points.h"

namespace lte::pathtrace {
namespace {

constexpr double kMaxOversampling = 8;
constexpr int64_t kProbePoints = 256;  // they estimate the reached share of the surface
constexpr uint64_t kSideStream = 1;    // of the seed: which of two sides a point stands on

void check_search(std::span<const Vec3> positions, std::span<const Vec3> normals,
                  const ReachOptions& options) {
  IrradianceOptions check;
  check.max_depth = options.max_depth;
  check_points(positions, normals);
  check_irradiance_options(check);
}

/// [count] the sides that light reaches of the first samples, as search_for_light() gives them.
std::vector<uint8_t> lit_sides(const Bvh& bvh, const scene::SurfaceSamples& samples, int64_t count,
                               const ReachOptions& options, const ReachRecall& recall) {
  const auto first = static_cast<size_t>(count);
  const auto positions = std::span(samples.position).first(first);
  const auto normals = std::span(samples.normal).first(first);
  check_search(positions, normals, options);
  std::vector<uint8_t> lit =
      search_for_light(bvh, positions, normals, Sides::Either, options, recall);
  const std::vector<size_t> again =
      lit_from_outside(bvh, lit, hash_combine(options.seed, kSideStream), samples);
  if (again.empty()) return lit;
  std::vector<Vec3> places, inner;
  for (const size_t i : again) {
    places.push_back(positions[i]);
    inner.push_back(lit[i] == kFrontLit ? -normals[i] : normals[i]);
  }
  ReachRecall fresh;
  fresh.check = recall.check;
  const std::vector<uint8_t> found =
      search_for_light(bvh, places, inner, Sides::Front, options, fresh);
  for (size_t k = 0; k < again.size(); ++k)
    if (found[k] != 0) lit[again[k]] = kFrontLit | kBackLit;
  return lit;
}

/// Indices of the samples to keep.
KeptSamples kept_samples(const Bvh& bvh, std::span<const uint8_t> lit,
                         const scene::SurfaceSamples& samples, Purpose purpose, uint64_t seed) {
  KeptSamples kept;
  const std::vector<uint8_t> lost =
      shines_at_nothing(bvh, samples, static_cast<int64_t>(lit.size()), seed);
  for (size_t i = 0; i < lit.size(); ++i) {
    const bool emits = purpose == Purpose::Scene && samples.light_group[i] != scene::kNone;
    if (emits) {
      (lost[i] != 0 ? kept.lost : kept.luminaires).push_back(i);
    } else if (lit[i] != 0) {
      kept.others.push_back(i);
    }
  }
  return kept;
}

/// sample_reached_surface() without the lights that are no surface.
scene::SurfaceSamples sample_surfaces(const Bvh& bvh, int64_t count,
                                      const scene::SamplerOptions& sampler, Purpose purpose,
                                      const ReachOptions& options, const ReachRecall& recall,
                                      PruneCounts* counts) {
  const uint64_t side_seed = hash_combine(options.seed, kSideStream);
  scene::SamplerOptions plain = sampler;
  plain.emissive_share = 0;
  const scene::SurfaceSamples probe = scene::sample_surface(bvh.scene(), kProbePoints, plain);
  const auto found =
      static_cast<double>(kept_samples(bvh, lit_sides(bvh, probe, probe.size(), options, recall),
                                       probe, purpose, side_seed)
                              .size());
  const double share = std::max(1.0, found) / kProbePoints;
  // Draws three standard errors of the share more than it asks for.
  const double error = std::sqrt((1 - share) / (share * kProbePoints));
  double oversampling = (1 + 3 * error) / share;
  for (;;) {
    oversampling = std::min(oversampling, kMaxOversampling);
    const auto drawn = static_cast<int64_t>(std::ceil(static_cast<double>(count) * oversampling));
    scene::SurfaceSamples samples = scene::sample_surface(bvh.scene(), drawn, sampler);
    const std::vector<uint8_t> lit = lit_sides(bvh, samples, drawn, options, recall);
    KeptSamples kept = kept_samples(bvh, lit, samples, purpose, side_seed);
    const int64_t left = kept.size();
    if (left < count && oversampling < kMaxOversampling) {
      oversampling *=
          1.05 * static_cast<double>(count) / static_cast<double>(std::max<int64_t>(1, left));
      continue;
    }
    if (left == 0) return scene::sample_surface(bvh.scene(), count, sampler);
    counts->drawn = drawn;
    counts->pruned = drawn - left;
    turn_to_light(bvh, lit, side_seed, &samples);
    reduce_samples(bvh.scene(), std::move(kept), count, &samples);
    return samples;
  }
}

}  // namespace

std::vector<uint8_t> reached(const Bvh& bvh, std::span<const Vec3> positions,
                             std::span<const Vec3> normals, Sides sides,
                             const ReachOptions& options) {
  check_search(positions, normals, options);
  std::vector<uint8_t> keep =
      search_for_light(bvh, positions, normals, sides, options, ReachRecall{});
  for (uint8_t& side : keep) side = side != 0 ? 1 : 0;
  return keep;
}

scene::SurfaceSamples sample_reached_surface(const Bvh& bvh, int64_t count,
                                             const scene::SamplerOptions& sampler, Purpose purpose,
                                             const ReachOptions& options, PruneCounts* counts) {
  return sample_reached_surface(bvh, count, sampler, purpose, options, ReachRecall{}, counts);
}

scene::SurfaceSamples sample_turned_surface(const Bvh& bvh, int64_t count,
                                            const scene::SamplerOptions& sampler,
                                            const ReachOptions& options) {
  scene::SurfaceSamples samples = scene::sample_surface(bvh.scene(), count, sampler);
  ReachRecall once;
  once.rounds = 1;
  // Lights that are no surface come last.
  const int64_t surface = scene::surface_point_count(bvh.scene(), count, sampler);
  const uint64_t side_seed = hash_combine(options.seed, kSideStream);
  turn_to_light(bvh, lit_sides(bvh, samples, surface, options, once), side_seed, &samples);
  std::vector<uint8_t> lost = shines_at_nothing(bvh, samples, surface, side_seed);
  lost.resize(samples.position.size());
  std::vector<size_t> rows;
  for (size_t i = 0; i < lost.size(); ++i)
    if (lost[i] == 0) rows.push_back(i);
  samples.keep(rows);
  return samples;
}

scene::SurfaceSamples sample_reached_surface(const Bvh& bvh, int64_t count,
                                             const scene::SamplerOptions& sampler, Purpose purpose,
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
      sample_surfaces(bvh, scene::surface_point_count(scene, count, sampler), surfaces, purpose,
                      options, recall, counts);
  const double area = std::accumulate(samples.area.begin(), samples.area.end(), 0.0);
  scene::append_light_points(scene, count,
                             static_cast<float>(area / static_cast<double>(samples.size())),
                             sampler, &samples);
  return samples;
}

}  // namespace lte::pathtrace
