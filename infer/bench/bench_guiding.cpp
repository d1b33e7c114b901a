// lte_bench guiding: a scene and a model, and what paths cost that its radiance decoder guides.
#include <string>
#include <tuple>
#include <vector>

#include "infer/bench/bench.h"
#include "infer/bench/guiding/guided_irradiance.h"
#include "infer/bench/guiding/guided_pixels.h"
#include "infer/renderer/renderer.h"
#include "infer/tool/assets.h"
#include "infer/tool/picture_size.h"
#include "lte/base/check.h"
#include "lte/pathtrace/placement/auto_camera.h"

namespace lte::infer {

std::vector<BenchResult> bench_guiding(const BenchOptions& options) {
  LTE_CHECK(!options.scene.empty() && !options.checkpoint.empty(),
            "guiding: name a scene (--scene) and a model with a radiance decoder (--checkpoint)");
  const scene::Scene scene = load_scene(options.scene, options.loading);
  const runtime::Network network(options.checkpoint);
  LTE_CHECK(network.config().predicts_radiance(), options.checkpoint,
            ": has no radiance decoder (its model.radiance_lobes is 0)");
  Renderer renderer(scene);
  EmbedSettings embedding;
  embedding.rescale = true;
  renderer.embed(network, embedding);
  const scene::Camera camera =
      scene.cameras.empty() ? pathtrace::auto_camera(renderer.bvh()) : scene.cameras.front();
  GuidingOptions guiding;
  std::tie(guiding.width, guiding.height) = parse_picture_size(options.picture_size);
  guiding.radius_m = options.radius_m;
  std::vector<GuidingRow> rows = guided_pixels(renderer, camera, guiding);
  for (const GuidingRow& row : guided_irradiance(renderer, guiding)) rows.push_back(row);
  std::vector<BenchResult> out;
  for (const GuidingRow& row : rows)
    out.push_back({row.name, row.paths, row.seconds, row.seconds, row.figures});
  return out;
}

}  // namespace lte::infer
