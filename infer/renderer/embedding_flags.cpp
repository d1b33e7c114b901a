#include "infer/renderer/embedding_flags.h"

#include "lte/base/check.h"
#include "lte/base/log.h"
#include "lte/base/timer.h"
#include "lte/embed/embedding_key.h"
#include "lte/embed/untrained_light.h"

namespace lte::infer {

void add_embedding_flags(CLI::App& app, EmbeddingFlags* flags) {
  CLI::Option* load = app.add_option(
      "--embedding", flags->load,
      "Read the scene's embedding from this file of --save-embedding instead of making it; one of "
      "another scene, model or setting is refused");
  app.add_option("--save-embedding", flags->save, "Also write the scene's embedding to this file")
      ->excludes(load);
}

void add_embedding_keys(SetKeys* keys, EmbeddingFlags* flags) {
  keys->add("scene_points", &flags->scene_points, 0, int64_t{1} << 28,
            "scene points shown to the network; 0: as many as the scene needs");
  keys->add("prune", &flags->prune, {"auto", "on", "off"},
            "show the network only surfaces that light reaches, and only light that reaches what "
            "is seen; auto: as in its training");
  keys->add("rescale", &flags->rescale,
            "shrink a scene larger than the model knows and enlarge one that is much smaller, for "
            "the network only; off: refuse the first, leave the second");
}

void claim_embedding(const EmbeddingFlags& flags, CommandFiles* files) {
  files->reads("--embedding", flags.load);
  files->writes("--save-embedding", flags.save);
}

EmbedSettings embed_settings(const EmbeddingFlags& flags, uint64_t seed,
                             const runtime::MemoryLimit& memory) {
  EmbedSettings settings;
  settings.scene_points = flags.scene_points;
  // Programs without rays read a file, too.
  settings.reader = flags.has_file() ? embed::Reader::Points : embed::Reader::Rays;
  settings.seed = seed;
  settings.rescale = flags.rescale;
  if (flags.prune != "auto") settings.prune = flags.prune == "on";
  settings.memory = memory;
  return settings;
}

std::vector<int> culled_lights(const EmbeddingFlags& flags, const pathtrace::Bvh& bvh,
                               const runtime::Network& network, const EmbedSettings& settings,
                               const embed::Receivers& receivers) {
  if (flags.has_file()) return {};
  return embed::culled_lights(bvh, network, settings, receivers);
}

double cull_lights(const EmbeddingFlags& flags, const pathtrace::Bvh& bvh,
                   const runtime::Network& network, const embed::Receivers& receivers,
                   EmbedSettings* settings) {
  const Timer timer;
  settings->culled_lights = culled_lights(flags, bvh, network, *settings, receivers);
  const double seconds = flags.has_file() ? 0 : timer.seconds();
  if (!settings->culled_lights.empty())
    log_info(embed::culled_lights_note(bvh.scene(), settings->culled_lights, receivers));
  return seconds;
}

bool knows_light(const EmbeddingFlags& flags, const pathtrace::Bvh& bvh,
                 const runtime::Network& network, const EmbedSettings& settings,
                 const embed::Receivers& receivers) {
  if (!embed::has_untrained_light(bvh.scene(), network.metadata())) return true;
  const std::vector<int> culled = culled_lights(flags, bvh, network, settings, receivers);
  if (!embed::has_untrained_light(bvh.scene(), network.metadata(), culled)) return true;
  log_info(embed::traced_light_note(bvh.scene(), culled));
  return false;
}

void provide_embedding(const EmbeddingFlags& flags, const runtime::Network& network,
                       const EmbedSettings& settings, Renderer* renderer) {
  if (!flags.has_file()) return renderer->embed(network, settings);
  const runtime::EmbeddingKey key = embed::embedding_key(renderer->bvh(), network, settings);
  const Timer timer;
  if (!flags.load.empty()) {
    renderer->set_embedding(runtime::load_embedding(flags.load, network, key, settings.memory));
    renderer->seconds().encode = timer.seconds();
    return;
  }
  renderer->embed(network, settings);
  save_embedding(flags.save, renderer->embedding(), key);
  log_info("wrote ", flags.save);
}

}  // namespace lte::infer
