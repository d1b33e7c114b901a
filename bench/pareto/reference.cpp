#include "bench/pareto/reference.h"

#include "infer/eval/measure/reference_pair.h"
#include "lte/image/metrics.h"

namespace lte::bench {

using namespace infer;

namespace {

/// Of the mean of two pictures: half of their difference, by which either is off it, has it.
ReferenceNoise noise_of(const image::Image& either, const image::Image& mean) {
  return {image::mse(either.pixels, mean.pixels), relative_mse(either, mean)};
}

}  // namespace

Reference find_reference(const MethodScene& scene, const scene::Camera& camera,
                         const std::string& name, int spp, const std::filesystem::path& folder) {
  PairSettings wanted;
  wanted.width = scene.width;
  wanted.height = scene.height;
  wanted.paths = (spp + 1) / 2;
  wanted.max_depth = scene.max_depth;
  wanted.folder = folder;
  const auto [a, b] = find_reference_pair(&scene.renderer, camera, name, wanted);
  Reference out{mean_of_pair(a.whole, b.whole), mean_of_pair(a.indirect, b.indirect), {}, {}};
  out.whole_noise = noise_of(a.whole, out.whole);
  out.indirect_noise = noise_of(a.indirect, out.indirect);
  return out;
}

}  // namespace lte::bench
