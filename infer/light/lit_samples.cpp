#include "infer/light/lit_samples.h"

#include <algorithm>
#include <utility>

#include "infer/light/unreached_light.h"
#include "lte/data/light_groups.h"

namespace lte::infer {
namespace {

// As in baked training data, so that the network sees luminaires as densely as it has learnt to.
constexpr double kEmissiveShare = 0.1;

}  // namespace

scene::SurfaceSamples sample_scene_points(const pathtrace::Bvh& bvh, int64_t count, bool prune,
                                          uint64_t seed, pathtrace::PruneCounts* counts,
                                          const pathtrace::ReachRecall& recall,
                                          const std::vector<int>& without) {
  scene::SamplerOptions sampler;
  sampler.seed = seed;
  sampler.emissive_share = kEmissiveShare;
  const int max_depth = pathtrace::ReachOptions().max_depth;
  if (!prune)
    return pathtrace::sample_turned_surface(bvh, count, sampler, {max_depth, seed, without});
  pathtrace::PruneCounts ignored;
  const auto reached_without = [&](const std::vector<int>& groups) {
    const pathtrace::ReachOptions reach{max_depth, seed, groups};
    return pathtrace::sample_reached_surface(bvh, count, sampler, pathtrace::Purpose::Scene, reach,
                                             recall, counts != nullptr ? counts : &ignored);
  };
  scene::SurfaceSamples samples = reached_without(without);
  if (without.empty()) return samples;
  const auto told = [&](int group) { return std::ranges::count(without, group) == 0; };
  keep_points(told, &samples);
  if (samples.position.empty()) {  // no light is left: of any surfaces the answer is darkness
    samples = reached_without({});
    keep_points(told, &samples);
  }
  return samples;
}

data::GroupedLight light_to_read(const pathtrace::LightEstimates& light,
                                 const runtime::LightRequest& input) {
  const bool indirect = input.depth > 1;
  data::GroupedLight read{.direct = light.direct};
  if (indirect) read.indirect = light.indirect;
  if (input.sides) read.direct_back = light.direct_back;
  if (input.sides && indirect) read.indirect_back = light.indirect_back;
  if (input.errors) {
    read.error = light.error;
    read.error_back = light.error_back;
  }
  return read;
}

LitSamples add_light_estimates(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                               scene::SurfaceSamples surface, const runtime::LightRequest& input,
                               uint64_t seed, std::span<const int> left_out) {
  LitSamples out{std::move(surface), {}};
  if (input.depth == 0) return out;
  const bool indirect = input.depth > 1;
  const scene::SurfaceSamples& s = out.surface;
  if (lights.empty()) {
    const std::vector<Rgb> dark(s.position.size());
    out.light.direct = dark;
    if (indirect) out.light.indirect = dark;
    if (input.sides) out.light.direct_back = dark;
    if (input.sides && indirect) out.light.indirect_back = dark;
    if (input.errors) out.light.error.resize(2 * dark.size());
    return out;
  }
  pathtrace::LightEstimates light =
      pathtrace::estimate_light(bvh, lights, s.position, s.normal, s.emission,
                                {.paths = input.paths, .max_depth = input.depth, .seed = seed});
  leave_out(left_out, lights.groups(), &light);
  out.light = data::sum_groups(light_to_read(light, input), lights.groups());
  return out;
}

}  // namespace lte::infer
