#include "infer/bench/pareto/renderer_steps.h"

namespace lte::infer {

void embed_scene(const MethodScene& scene, StageTimes* stages) {
  EmbedSettings embedding;
  embedding.seed = scene.seed;
  embedding.rescale = true;
  scene.renderer.embed(scene.network, embedding);
  const StageSeconds& seconds = scene.renderer.seconds();
  (*stages)["sample"] += seconds.sample;
  (*stages)["light"] += seconds.light;
  (*stages)["encode"] += seconds.encode;
}

MethodPicture render_view(const MethodScene& scene, const RenderSettings& settings,
                          const scene::Camera& camera) {
  RenderSettings asked = settings;
  asked.width = scene.width;
  asked.height = scene.height;
  asked.max_depth = scene.max_depth;
  asked.seed = scene.seed;
  return picture_of(scene.renderer.render(camera, asked));
}

}  // namespace lte::infer
