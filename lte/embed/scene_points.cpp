#include "lte/embed/scene_points.h"

#include <algorithm>

#include "lte/embed/culled_lights.h"

namespace lte::embed {
namespace {

// As in baked training data, so that the network sees luminaires as densely as it has learnt to.
constexpr double kEmissiveShare = 0.1;

}  // namespace

scene::SurfaceSamples sample_scene_points(const pathtrace::Bvh& bvh, int64_t count, bool prune,
                                          uint64_t seed, pathtrace::PruneCounts* counts,
                                          const pathtrace::ReachRecall& recall,
                                          const std::vector<int>& culled) {
  scene::SamplerOptions sampler;
  sampler.seed = seed;
  sampler.emissive_share = kEmissiveShare;
  const int max_depth = pathtrace::ReachOptions().max_depth;
  if (!prune)
    return pathtrace::sample_turned_surface(bvh, count, sampler, {max_depth, seed, culled});
  pathtrace::PruneCounts ignored;
  const auto reached = [&](const std::vector<int>& groups) {
    const pathtrace::ReachOptions reach{max_depth, seed, groups};
    return pathtrace::sample_reached_surface(bvh, count, sampler, pathtrace::Purpose::Scene, reach,
                                             recall, counts != nullptr ? counts : &ignored);
  };
  scene::SurfaceSamples samples = reached(culled);
  if (culled.empty()) return samples;
  const auto kept = [&](int group) { return std::ranges::count(culled, group) == 0; };
  keep_points(kept, &samples);
  if (samples.position.empty()) {  // no light is left: of any surfaces the answer is darkness
    sampler.emissive_share = sampler.environment_share = 0;
    sampler.punctual_lights = false;
    samples = scene::sample_surface(bvh.scene(), count, sampler);
    std::ranges::fill(samples.emission, Rgb{});
    std::ranges::fill(samples.light_group, scene::kNone);
  }
  return samples;
}

}  // namespace lte::embed
