#include "infer/view/view_command.h"

#include <chrono>
#include <csignal>
#include <cstdio>
#include <exception>
#include <memory>
#include <optional>
#include <thread>
#include <utility>

#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>
#include <nlohmann/json.hpp>

#include "infer/tool/picture_size.h"
#include "infer/tool/tool_keys.h"
#include "infer/view/live_view.h"
#include "infer/view/load_session.h"
#include "infer/view/page_files.h"
#include "infer/view/replies.h"
#include "infer/view/server.h"
#include "lte/base/check.h"
#include "lte/base/file.h"
#include "lte/base/log.h"
#include "lte/base/process_memory.h"
#include "lte/base/text.h"
#include "lte/base/timer.h"
#include "lte/cli/command_files.h"
#include "lte/cli/writable.h"
#include "lte/scene/light_points.h"
#include "lte/scene/load_camera.h"

namespace lte::infer::view {
namespace {

namespace asio = boost::asio;

/// How long pages have to hear why the server ends.
constexpr std::chrono::milliseconds kFarewell(1500), kFarewellStep(10);

std::string check_token(const std::string& text) {
  return text == "auto" || is_token(text)
             ? ""
             : "expected auto, or 8 to 128 letters, digits, '-' and '_'";
}

std::string check_view_size(const std::string& text) {
  const auto [width, height] = parse_picture_size(text);
  const bool good = std::min(width, height) >= kMinSide && std::max(width, height) <= kMaxSide;
  return good ? "" : concat("expected WIDTHxHEIGHT, each ", kMinSide, " to ", kMaxSide);
}

Listen listen_of(const ViewRequest& request) {
  Listen listen{request.host, static_cast<uint16_t>(request.port), request.token};
  const bool by_chance =
      request.token == "auto" || (request.token.empty() && !parse_host(request.host).is_loopback());
  if (by_chance) listen.token = random_token();
  return listen;
}

/// How light is computed, for people.
const char* words_of(const std::string& integrator) {
  return integrator == "network" ? "gathered from the network's light"
                                 : "gathered from traced light, no network";
}

/// The server from its first connection to its last.
class Run {
 public:
  Run(const ViewRequest& request, const CommandFiles& files)
      : request_(request),
        files_(files),
        page_(page_folder()),
        view_(&io_),
        server_(&io_, listen_of(request), &page_, view_.hub()),
        signals_(io_),
        farewell_(io_) {}

  /// @throws what loading threw
  void serve() {
    std::printf("lte_view: %s (indirect light: %s)\n", server_.address().c_str(),
                words_of(request_.integrator));
    std::fflush(stdout);
    std::thread loader([this] { load(); });
    io_.run();
    loader.join();
    if (failure_) std::rethrow_exception(failure_);
  }

  nlohmann::json report() const {
    const LiveView::Counts counts = view_.counts();
    return {{"scene", request_.scene},        {"load_seconds", load_seconds_},
            {"passes", counts.view.passes},   {"pictures", counts.view.pictures},
            {"cameras", counts.view.cameras}, {"edits", counts.edits},
            {"peak_rss_mb", peak_rss_mb()}};
  }

 private:
  void load() {
    try {
      const Timer timer;
      auto loaded = std::make_shared<LoadedSession>(load_session(request_, files_));
      load_seconds_ = timer.seconds();
      asio::post(io_, [this, loaded] { begin(loaded.get()); });
    } catch (const std::exception& error) {
      asio::post(io_, [this, failure = std::current_exception(), line = first_line(error.what())] {
        failure_ = failure;
        end(failed_reply(line));
      });
    }
  }

  void begin(LoadedSession* loaded) {
    view_.begin(std::move(loaded->session), loaded->first);
    log_info("ready after ", load_seconds_, " s; Ctrl-C ends");
    // Until now a signal ends the process at once, as there is no way to stop loading.
    signals_.add(SIGINT);
    signals_.add(SIGTERM);
    signals_.async_wait([this](boost::system::error_code error, int) {
      if (!error) end("");
    });
  }

  /// Tells pages the last words and waits, though not for long, until they have heard them.
  void end(const std::string& words) {
    server_.stop();
    view_.hub()->close_all(words);
    deadline_ = std::chrono::steady_clock::now() + kFarewell;
    wait_for_pages();
  }

  void wait_for_pages() {
    if (view_.hub()->empty() || std::chrono::steady_clock::now() > deadline_) return io_.stop();
    farewell_.expires_after(kFarewellStep);
    farewell_.async_wait([this](boost::system::error_code error) {
      if (!error) wait_for_pages();
    });
  }

  const ViewRequest& request_;
  const CommandFiles& files_;
  const PageFiles page_;
  asio::io_context io_{1};
  LiveView view_;
  Server server_;
  asio::signal_set signals_;
  asio::steady_timer farewell_;
  std::chrono::steady_clock::time_point deadline_;
  double load_seconds_ = 0;
  std::exception_ptr failure_;
};

}  // namespace

void add_view_options(CLI::App& app, ViewRequest* r) {
  app.add_option("scene", r->scene, "Scene to show: .gltf, .glb, .pbrt, .obj or .ply")->required();
  app.add_option("--integrator", r->integrator,
                 "How indirect light is computed. gather: rays from the pixels read light that "
                 "paths have found at places of the scene, the least error and the first picture "
                 "soonest; network: they read the network's light there")
      ->check(CLI::IsMember({"gather", "network"}))
      ->capture_default_str();
  app.add_option("--checkpoint", r->checkpoint, "Model, with --integrator network; by default lte");
  app.add_option("--host", r->host,
                 "Address to listen to: by default this machine alone; any other, such as 0.0.0.0, "
                 "asks pages for a token")
      ->capture_default_str();
  app.add_option("--port", r->port, "Port to listen to; 0 for any that is free")
      ->check(CLI::Range(0, 65535))
      ->capture_default_str();
  app.add_option(
         "--token", r->token,
         "What the address of the page must have behind ?token=, or auto for one by chance; "
         "by default none is needed on this machine")
      ->check(CLI::Validator(check_token, "TOKEN"));
  app.add_option("--camera", r->camera,
                 concat(scene::kCameraHelp, "; by default the scene's first camera, else auto"));
  app.add_option("--size", r->size, "Size of the picture, which pages may change")
      ->check(CLI::Validator(check_view_size, "WxH"))
      ->capture_default_str();
  app.add_option("--seed", r->seed, "Seed of scene points")->capture_default_str();
  app.add_flag("--validate-only", r->validate_only,
               "Load scene, camera and model, and serve nothing");
  r->keys.add("records", &r->records, 2, int64_t{1} << 22,
              "places that the irradiance cache knows");
  r->keys.add("scene_points", &r->scene_points, 0, int64_t{1} << 28,
              "of network: scene points shown to it; 0: as many as the scene needs");
  r->keys.add("rescale", &r->rescale,
              "of network: shrink a scene larger than the model knows, for it only");
  add_scene_keys(&r->keys, r);
  add_network_keys(&r->keys, &r->tool);
  r->keys.add_to(&app);
  app.parse_complete_callback([r] { r->keys.read(); });
  add_scene_options(app, r);
  add_plain_tool_options(app, &r->tool);
}

void run_view(const ViewRequest& request) {
  LTE_CHECK(request.checkpoint.empty() || request.integrator == "network",
            "--checkpoint goes with --integrator network: ", request.integrator, " needs no model");
  CommandFiles files;
  claim_scene(request, &files);
  files.reads("--checkpoint", request.checkpoint);
  files.reads("--camera", request.camera);
  files.writes_common(request.tool.common);
  files.check();
  apply_tool_options(request.tool);
  check_writable(request.tool.common.json);
  parse_host(request.host);
  if (request.validate_only) {
    const LoadedSession loaded = load_session(request, files);
    return print_valid_scene(loaded.session->state()->scene(), request.scene);
  }
  Run run(request, files);
  run.serve();
  if (!request.tool.common.json.empty())
    write_file(request.tool.common.json, run.report().dump(2) + '\n');
}

}  // namespace lte::infer::view
