#include "lte/embed/embedding_key.h"

#include <string>

#include "lte/embed/scene_points.h"
#include "lte/scene/fingerprint.h"

namespace lte::embed {

runtime::EmbeddingKey embedding_key(const pathtrace::Bvh& bvh, const runtime::Network& network,
                                    const EmbedSettings& settings) {
  const scene::Fingerprint print = fingerprint(bvh.scene());
  return {{"scene geometry", print.geometry},
          {"scene materials", print.materials},
          {"scene lights", print.lights},
          {"scene-points", std::to_string(scene_point_count(bvh, network, settings))},
          {"drawn by rules", std::to_string(kScenePointsVersion)},
          {"prune", settings.prunes(network) ? "on" : "off"},
          {"seed", std::to_string(settings.seed)}};
}

}  // namespace lte::embed
