#include "infer/renderer/light_request.h"

#include "infer/tool/tool_keys.h"
#include "lte/base/check.h"
#include "lte/base/log.h"
#include "lte/cli/assets.h"
#include "lte/embed/untrained_light.h"
#include "lte/scene/light_points.h"

namespace lte::infer {

void add_light_flags(CLI::App& app, const std::string& from, LightRequest* r) {
  app.add_option("--integrator", r->integrator,
                 concat("How light is computed. gather: rays from ", from,
                        " read path-traced light in an irradiance cache on surfaces, the least "
                        "error for its time; network: the same rays read light that the network "
                        "knows there; path: path tracing alone, without bias"))
      ->check(CLI::IsMember({"gather", "network", "path"}))
      ->capture_default_str();
  app.add_option("--checkpoint", r->checkpoint,
                 "Model, with --integrator network: a file, or a shipped one by name; by default "
                 "lte");
  app.add_option("--seed", r->seed, "Seed of all samples")->capture_default_str();
}

void add_light_keys(const std::string& start, LightRequest* r) {
  r->keys.add("depth", &r->max_depth, 1, 1000,
              concat("surface hits of light's path after ", start));
  const bool chosen = r->records == 0;
  r->keys.add("records", &r->records, chosen ? 0 : 2, int64_t{1} << 22,
              concat("of gather and network: places that the irradiance cache knows",
                     chosen ? "; 0: by the rays that read them" : ""));
}

void add_tool_flags(CLI::App& app, LightRequest* r) {
  r->flags = &app;
  add_scene_keys(&r->keys, r);
  add_embedding_keys(&r->keys, &r->embedding);
  add_network_keys(&r->keys, &r->tool);
  r->keys.add_to(&app);
  app.parse_complete_callback([r] { r->keys.read(); });
  add_scene_options(app, r);
  add_plain_tool_options(app, &r->tool);
}

const char* first_given(const CLI::App& app, std::initializer_list<const char*> flags) {
  for (const char* name : flags) {
    const CLI::Option* const option = app.get_option_no_throw(name);
    if (option != nullptr && option->count() > 0) return name;
  }
  return nullptr;
}

const char* first_set(const SetKeys& keys, std::initializer_list<const char*> names) {
  for (const char* name : names) {
    if (keys.is_given(name)) return name;
  }
  return nullptr;
}

void check_light_used(const LightRequest& r, std::initializer_list<const char*> gather_keys) {
  const char* const network =
      first_given(*r.flags, {"--checkpoint", "--embedding", "--save-embedding"});
  LTE_CHECK(network == nullptr || r.needs_network(), network,
            " goes with --integrator network: ", r.integrator, " needs no model");
  const char* const network_key =
      first_set(r.keys, {"scene_points", "prune", "rescale", "device", "precision"});
  LTE_CHECK(network_key == nullptr || r.needs_network(), "--set ", network_key,
            " goes with --integrator network: ", r.integrator, " needs no model");
  const char* const gather_key = first_set(r.keys, gather_keys);
  LTE_CHECK(gather_key == nullptr || !r.by_paths(), "--set ", gather_key,
            " goes with --integrator gather or network, not path");
}

void claim_light_files(const LightRequest& request, CommandFiles* files) {
  claim_scene(request, files);
  claim_embedding(request.embedding, files);
  files->reads("--checkpoint", request.checkpoint);
  files->writes_common(request.tool.common);
}

render::CacheSettings cache_settings(const LightRequest& request) {
  render::CacheSettings out;
  out.records = request.records;
  out.max_depth = request.max_depth;
  return out;
}

runtime::Network load_network(const LightRequest& request, const scene::Scene& scene) {
  runtime::Network network = request.network
                                 ? *request.network
                                 : runtime::Network(checkpoint_or_shipped(request.checkpoint),
                                                    network_options(request.tool));
  network.check_fits(max_component(scene::point_bounds(scene).extent()), request.embedding.rescale);
  return network;
}

EmbedSettings embed_settings(const LightRequest& request, const runtime::Network& network,
                             const embed::Receivers& receivers, const Renderer& renderer) {
  EmbedSettings settings = embed_settings(request.embedding, request.seed,
                                          runtime::MemoryLimit(request.tool.max_memory_mb));
  cull_lights(request.embedding, renderer.bvh(), network, receivers, &settings);
  const std::string note = embed::untrained_light_note(renderer.bvh().scene(), network.metadata(),
                                                       settings.culled_lights);
  if (!note.empty()) log_warning(note);
  return settings;
}

}  // namespace lte::infer
