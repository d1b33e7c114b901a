// Few paths a pixel and a denoiser: what a user without the network would do.
#include <memory>
#include <utility>

#include "infer/bench/pareto/method.h"
#include "infer/bench/pareto/traced_picture.h"
#include "lte/base/timer.h"
#include "lte/image/denoise.h"
#include "lte/pathtrace/gbuffer.h"

namespace lte::infer {
namespace {

struct DenoiserGuides {
  image::Image normal, position, albedo;
};

/// What the centres of the pixels see: free of noise, if not of stairs.
DenoiserGuides trace_guides(const MethodScene& scene, const scene::Camera& camera) {
  const pathtrace::GBuffer hits =
      pathtrace::trace_gbuffer(scene.renderer.bvh(), camera, scene.width, scene.height);
  const image::Image black(scene.width, scene.height, 3);
  DenoiserGuides out{black, black, black};
  for (int y = 0; y < scene.height; ++y) {
    for (int x = 0; x < scene.width; ++x) {
      const size_t i =
          static_cast<size_t>(y) * static_cast<size_t>(scene.width) + static_cast<size_t>(x);
      if (!hits.mask[i]) continue;
      out.normal.set_rgb(x, y, hits.normal[i]);
      out.position.set_rgb(x, y, hits.position[i]);
      out.albedo.set_rgb(x, y, hits.albedo[i]);
    }
  }
  return out;
}

/// Reflected light without its noise. Where a pixel's centre sees no surface it stays as it is.
image::Image denoise_reflected(const image::Denoiser& denoiser, const image::Image& light,
                               const DenoiserGuides& guides) {
  image::NoisyPicture noisy;
  noisy.light = &light;
  noisy.normal = &guides.normal;
  noisy.position = &guides.position;
  noisy.albedo = &guides.albedo;
  image::Image out = denoiser.denoise(noisy);
  for (size_t i = 0; i < out.pixels.size(); i += 3) {
    const float* n = guides.normal.pixels.data() + i;
    if (n[0] != 0 || n[1] != 0 || n[2] != 0) continue;
    for (size_t c = i; c < i + 3; ++c) out.pixels[c] = light.pixels[c];
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
  const auto guides = std::make_shared<const DenoiserGuides>(trace_guides(scene, camera));
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
