#include "bench/pareto/reference.h"

#include <utility>

#include "infer/eval/measure/reference_pair.h"
#include "lte/image/metrics.h"

namespace lte::bench {

using namespace infer;

namespace {

/// Makes `image` the mean of both pictures. Half of their difference has the noise of that mean.
ReferenceNoise merge(const image::Image& other, image::Image* image) {
  image::Image moved = other;  // the mean and its noise, as a picture of the same light
  for (size_t i = 0; i < image->pixels.size(); ++i) {
    const float mean = 0.5F * (image->pixels[i] + other.pixels[i]);
    moved.pixels[i] = mean + 0.5F * (image->pixels[i] - other.pixels[i]);
    image->pixels[i] = mean;
  }
  return {image::mse(moved.pixels, image->pixels), relative_mse(moved, *image)};
}

}  // namespace

Reference trace_reference(const MethodScene& scene, const scene::Camera& camera,
                          const std::string& name, int spp) {
  PairSettings wanted;
  wanted.width = scene.width;
  wanted.height = scene.height;
  wanted.paths = (spp + 1) / 2;
  wanted.max_depth = scene.max_depth;
  ReferencePair pair = find_reference_pair(&scene.renderer, camera, name, wanted);
  Reference out;
  out.whole = std::move(pair[0].whole);
  out.indirect = std::move(pair[0].indirect);
  out.whole_noise = merge(pair[1].whole, &out.whole);
  out.indirect_noise = merge(pair[1].indirect, &out.indirect);
  return out;
}

}  // namespace lte::bench
