#include "infer/common/lit_samples.h"

#include <utility>

#include "lte/data/dataset.h"
#include "lte/data/light_groups.h"
#include "lte/pathtrace/light_estimates.h"

namespace lte::infer {

LitSamples add_light_estimates(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                               scene::SurfaceSamples surface, const runtime::LightRequest& input,
                               uint64_t seed) {
  LitSamples out{std::move(surface), {}, {}};
  if (input.depth == 0) return out;
  const size_t count = out.surface.position.size();
  out.direct.resize(count);
  if (input.depth > 1) out.indirect.resize(count);
  if (lights.empty()) return out;
  const scene::SurfaceSamples& s = out.surface;
  const pathtrace::LightEstimates light =
      pathtrace::estimate_light(bvh, lights, s.position, s.normal, s.emission,
                                {.paths = input.paths, .max_depth = input.depth, .seed = seed});
  out.direct = data::sum_groups(light.direct, lights.groups(), 1);
  if (input.depth > 1) out.indirect = data::sum_groups(light.indirect, lights.groups(), 1);
  return out;
}

}  // namespace lte::infer
