#include <numeric>
#include <utility>

#include "infer/bench/pareto/method.h"
#include "infer/bench/pareto/traced_picture.h"

namespace lte::infer {

TracedPicture trace_picture(const MethodScene& scene, const scene::Camera& camera, int paths,
                            uint64_t seed, const pathtrace::PixelsDone& done) {
  std::vector<int64_t> pixels(static_cast<size_t>(scene.width) * static_cast<size_t>(scene.height));
  std::iota(pixels.begin(), pixels.end(), int64_t{0});
  const std::vector<pathtrace::PixelRadiance> seen =
      pathtrace::trace_pixels(scene.renderer.bvh(), scene.renderer.lights(), camera, scene.width,
                              scene.height, pixels, {paths, scene.max_depth + 1, seed}, done);
  const image::Image black(scene.width, scene.height, 3);
  TracedPicture out{black, black, black};
  for (int y = 0; y < scene.height; ++y) {
    for (int x = 0; x < scene.width; ++x) {
      const pathtrace::PixelRadiance& pixel =
          seen[static_cast<size_t>(y) * static_cast<size_t>(scene.width) + static_cast<size_t>(x)];
      out.whole.set_rgb(x, y, pixel.emission + pixel.direct + pixel.indirect);
      out.emission.set_rgb(x, y, pixel.emission);
      out.indirect.set_rgb(x, y, pixel.indirect);
    }
  }
  return out;
}

Method path_tracing(int paths) {
  const std::string count = std::to_string(paths);
  Method method{
      "paths-" + count, "paths", count + (paths == 1 ? " path" : " paths") + " a pixel", {}};
  method.prepare = [paths](const MethodScene& scene, StageTimes*) -> RenderView {
    return [scene, paths](const scene::Camera& camera, StageTimes*) {
      TracedPicture traced = trace_picture(scene, camera, paths, scene.seed, {});
      return MethodPicture{std::move(traced.whole),
                           [indirect = std::move(traced.indirect)] { return indirect; }};
    };
  };
  return method;
}

}  // namespace lte::infer
