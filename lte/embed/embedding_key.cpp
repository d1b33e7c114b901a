#include "lte/embed/embedding_key.h"

#include <string>

#include "lte/embed/scene_points.h"
#include "lte/scene/fingerprint.h"

namespace lte::embed {

runtime::EmbeddingKey embedding_key(const scene::Scene& scene, const runtime::Network& network,
                                    const EmbedSettings& settings) {
  const scene::Fingerprint print = fingerprint(scene);
  const int64_t points =
      settings.scene_points > 0 ? settings.scene_points : network.metadata().scene_points;
  return {{"scene geometry", print.geometry},
          {"scene materials", print.materials},
          {"scene lights", print.lights},
          {"scene-points", std::to_string(points)},
          {"drawn by rules", std::to_string(kScenePointsVersion)},
          {"prune", settings.prunes(network) ? "on" : "off"},
          {"seed", std::to_string(settings.seed)}};
}

}  // namespace lte::embed
