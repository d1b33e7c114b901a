// Few paths a pixel and a denoiser: what a user without the network would do.
#include <memory>
#include <utility>

#include "infer/bench/pareto/method.h"
#include "infer/bench/pareto/traced_picture.h"
#include "infer/picture/surface_guides.h"
#include "lte/base/timer.h"
#include "lte/image/denoise.h"

namespace lte::infer {
namespace {

/// Reflected light without its noise. Where a pixel's centre sees no surface it stays as it is.
image::Image denoise_reflected(const image::Denoiser& denoiser, const image::Image& light,
                               const SurfaceGuides& guides) {
  image::NoisyPicture noisy;
  noisy.light = &light;
  noisy.normal = &guides.normal;
  noisy.position = &guides.position;
  noisy.albedo = &guides.albedo;
  image::Image out = denoiser.denoise(noisy);
  for (size_t i = 0; i < guides.pixels(); ++i) {
    if (guides.mask[i]) continue;
    for (size_t c = 3 * i; c < 3 * i + 3; ++c) out.pixels[c] = light.pixels[c];
  }
  return out;
}

MethodPicture denoised_picture(const MethodScene& scene, const scene::Camera& camera, int paths,
                               const std::shared_ptr<const image::Denoiser>& denoiser,
                               StageTimes* stages) {
  Timer timer;
  TracedPicture traced = trace_picture(scene, camera, paths, scene.seed, {});
  (*stages)["paths"] += timer.seconds();
  timer.restart();
  const auto guides = std::make_shared<const SurfaceGuides>(
      trace_guides(scene.renderer.bvh(), camera, scene.width, scene.height));
  (*stages)["primary"] += timer.seconds();
  timer.restart();
  image::Image light = traced.whole;
  for (size_t i = 0; i < light.pixels.size(); ++i) light.pixels[i] -= traced.emission.pixels[i];
  image::Image whole = denoise_reflected(*denoiser, light, *guides);
  for (size_t i = 0; i < whole.pixels.size(); ++i) whole.pixels[i] += traced.emission.pixels[i];
  (*stages)["denoise"] += timer.seconds();
  // Of indirect light alone one picture is denoised too, which takes as long.
  return {std::move(whole), [denoiser, guides, indirect = std::move(traced.indirect)] {
            return denoise_reflected(*denoiser, indirect, *guides);
          }};
}

}  // namespace

Method denoised_paths(int paths) {
  const std::string count = std::to_string(paths);
  Method method{"denoised-" + count,
                "denoised",
                count + (paths == 1 ? " path" : " paths") +
                    " a pixel, then Open Image Denoise where it is found, else lte's filter",
                {}};
  method.prepare = [paths](const MethodScene& scene, StageTimes* stages) -> RenderView {
    const Timer timer;
    const auto denoiser = std::make_shared<const image::Denoiser>();
    (*stages)[denoiser->is_oidn() ? "Open Image Denoise" : "bilateral filter"] += timer.seconds();
    return [scene, paths, denoiser](const scene::Camera& camera, StageTimes* view) {
      return denoised_picture(scene, camera, paths, denoiser, view);
    };
  };
  return method;
}

}  // namespace lte::infer
