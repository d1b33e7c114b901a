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

void make_table(const MethodScene& scene, const TableSettings& table, StageTimes* stages) {
  TableSettings wanted = table;
  wanted.max_depth = scene.max_depth;
  wanted.seed = scene.seed;
  scene.renderer.make_table(wanted);
  (*stages)["table"] += scene.renderer.seconds().table;
}

void add_picture_stages(const MethodScene& scene, StageTimes* view) {
  const StageSeconds& seconds = scene.renderer.seconds();
  (*view)["primary"] += seconds.primary;
  (*view)["gather"] += seconds.gather;
  (*view)[kDirect] += seconds.direct;
  (*view)["denoise"] += seconds.denoise;
  (*view)["paths"] += seconds.reference;
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
