#include "infer/view/load_session.h"

#include <optional>
#include <utility>

#include "infer/render/scene_size.h"
#include "infer/render/views.h"
#include "infer/tool/picture_size.h"
#include "lte/base/check.h"
#include "lte/base/log.h"
#include "lte/cli/assets.h"
#include "lte/embed/untrained_light.h"
#include "lte/pathtrace/reach/lost_light.h"
#include "lte/scene/light_points.h"

namespace lte::infer::view {
namespace {

runtime::Network load_network(const ViewRequest& request) {
  return runtime::Network(checkpoint_or_shipped(request.checkpoint), network_options(request.tool));
}

/// Says what the network makes of the scene.
/// @throws runtime::LimitError where it cannot be used
void check_network(const ViewRequest& request, const pathtrace::Bvh& bvh,
                   const runtime::Network& network, const SessionSettings& settings) {
  check_size(request.scene, bvh.scene(), network, request.rescale);
  settings.embedding.memory.check_encoding(
      network.config(), embed::scene_point_count(bvh, network, settings.embedding));
}

/// Warns of light that the network reads and does not know, or that is traced for that.
void warn_of_light(const ViewRequest& request, const SessionState& state,
                   const runtime::ModelMetadata& model) {
  const std::vector<int> culled = state.culled_lights();
  if (!embed::has_untrained_light(state.scene(), model, culled)) return;
  log_warning(request.scene,
              ": the model was trained without a sun or sky: indirect light is gathered from "
              "traced light");
}

/// What is seen until a page asks for anything else.
ViewState first_view(const ViewRequest& request, const pathtrace::Bvh& bvh) {
  const auto [width, height] = parse_picture_size(request.size);
  const float aspect = static_cast<float>(width) / static_cast<float>(height);
  pathtrace::warn_of_lost_light(request.scene, bvh);
  const std::vector<View> views = choose_views(bvh, request.camera, "", aspect);
  LTE_CHECK(views.size() == 1, "--camera ", request.camera, ": expected one camera, got ",
            views.size());
  check_in_view(bvh.scene(), bvh.bounds(), views, aspect);
  ViewState first;
  first.camera = views.front().camera;
  first.size = {width, height};
  return first;
}

SessionSettings settings_of(const ViewRequest& request) {
  SessionSettings settings;
  settings.embedding.scene_points = request.scene_points;
  settings.embedding.reader = embed::Reader::Rays;
  settings.embedding.seed = request.seed;
  settings.embedding.rescale = request.rescale;
  settings.embedding.memory = runtime::MemoryLimit(request.tool.max_memory_mb);
  settings.pictures = parse_enum<Method>("--integrator", request.integrator);
  settings.cache.records = request.records;
  return settings;
}

}  // namespace

LoadedSession load_session(const ViewRequest& request, const CommandFiles& files) {
  scene::Scene scene = load_source(request);
  describe(scene, request.scene);
  const bool lit = !scene.light_groups.empty();
  if (!lit)
    log_warning(request.scene,
                ": nothing emits light; there is nothing to see but surfaces "
                "(--environment 1,1,1 or --add-light auto gives it some)");
  std::optional<runtime::Network> network;
  if (lit && request.integrator == "network") network = load_network(request);
  SessionSettings settings = settings_of(request);
  LoadedSession out;
  {
    const pathtrace::Bvh bvh(scene);
    if (network) check_network(request, bvh, *network, settings);
    files.check_what_was_read();
    out.first = first_view(request, bvh);
  }
  settings.cameras = {out.first.camera};
  std::optional<runtime::ModelMetadata> model;
  if (network) model = network->metadata();
  out.session = std::make_unique<Session>(std::move(scene), std::move(network), settings);
  if (model) warn_of_light(request, *out.session->state(), *model);
  return out;
}

}  // namespace lte::infer::view
