// Few paths a pixel and a denoiser: what a user without the network would do.
#include <memory>
#include <utility>

#include "infer/bench/pareto/method.h"
#include "infer/bench/pareto/traced_picture.h"
#include "infer/picture/picture_band.h"
#include "infer/picture/surface_guides.h"
#include "infer/renderer/denoised_paths.h"
#include "lte/base/timer.h"
#include "lte/image/denoise.h"

namespace lte::infer {
namespace {

/// As the default of --aa.
constexpr int kHitsAtEdges = 16;

MethodPicture denoised_picture(const MethodScene& scene, const scene::Camera& camera, int paths,
                               const std::shared_ptr<const image::Denoiser>& denoiser,
                               StageTimes* stages) {
  Timer timer;
  TracedPicture traced = trace_picture(scene, camera, paths, scene.seed, {});
  (*stages)["paths"] += timer.seconds();
  timer.restart();
  // Albedo, normals and emission are those of whole pixels, as renderers give them to denoisers.
  const pathtrace::GBuffer hits =
      pathtrace::trace_gbuffer(scene.renderer.bvh(), camera, scene.width, scene.height);
  const auto guides = std::make_shared<const SurfaceGuides>(guides_of(hits));
  const PictureBand band(scene.renderer.bvh(), camera, {scene.width, scene.height, 0, scene.height},
                         {.antialias = kHitsAtEdges, .mean_normal = true}, &hits);
  const auto seen = std::make_shared<const Frame>(band.resolve({}));
  (*stages)["primary"] += timer.seconds();
  timer.restart();
  image::Image light = traced.whole;
  for (size_t i = 0; i < light.pixels.size(); ++i) light.pixels[i] -= traced.emission.pixels[i];
  image::Image whole =
      denoise_reflected(*denoiser, *guides, light, {seen->albedo, seen->mean_normal});
  for (size_t i = 0; i < whole.pixels.size(); ++i) whole.pixels[i] += seen->emission.pixels[i];
  (*stages)["denoise"] += timer.seconds();
  // Of indirect light alone one picture is denoised too, which takes as long.
  return {
      std::move(whole), [denoiser, guides, seen, indirect = std::move(traced.indirect)] {
        return denoise_reflected(*denoiser, *guides, indirect, {seen->albedo, seen->mean_normal});
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
