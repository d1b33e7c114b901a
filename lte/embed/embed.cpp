#include "lte/embed/embed.h"

#include <utility>

#include "lte/base/timer.h"
#include "lte/embed/point_light.h"
#include "lte/embed/scene_points.h"
#include "lte/embed/untrained_light.h"

namespace lte::embed {

std::vector<int> culled_lights(const pathtrace::Bvh& bvh, const runtime::Network& network,
                               const EmbedSettings& settings, const Receivers& receivers) {
  if (!settings.prunes(network)) return {};
  return culled_lights(bvh, receivers, settings.seed);
}

int64_t scene_point_count(const pathtrace::Bvh& bvh, const runtime::Network& network,
                          const EmbedSettings& settings) {
  if (settings.scene_points > 0) return settings.scene_points;
  return scene_point_count(bvh, network.metadata().scene_points, settings.reader);
}

Embedded embed(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
               const runtime::Network& network, const EmbedSettings& settings) {
  const std::vector<int> culled =
      settings.prunes(network) ? settings.culled_lights : std::vector<int>();
  const int64_t count = scene_point_count(bvh, network, settings);
  Timer timer;
  pathtrace::PruneCounts pruned;
  scene::SurfaceSamples samples =
      sample_scene_points(bvh, count, settings.prunes(network), settings.seed, &pruned, {}, culled);
  drop_untrained_suns(bvh.scene(), network.metadata(), &samples, culled);
  const double sample_s = timer.seconds();
  timer.restart();
  LitSamples lit = add_light_estimates(bvh, lights, std::move(samples), network.light_request(),
                                       settings.seed, culled);
  solve_traced_lights(bvh, lights, network.config(), settings.seed, culled, &lit);
  const double light_s = timer.seconds();
  timer.restart();
  runtime::SceneEmbedding embedding(
      network, lit.points(),
      runtime::EncodeOptions{settings.rescale, {}, settings.memory, settings.record_attention});
  return {std::move(embedding), pruned, culled, sample_s, light_s, timer.seconds()};
}

}  // namespace lte::embed
