// Variance of indirect light by paths that a radiance decoder guides, beside paths drawn by the
// material alone: at pixels of a picture, and as irradiance at points over the surfaces (the
// paper's supplement, section 4).
#include "experiments/command.h"

#include <functional>
#include <memory>
#include <string>
#include <tuple>
#include <vector>

#include "bench/begin_command.h"
#include "bench/bench.h"
#include "experiments/guiding/guided_irradiance.h"
#include "experiments/guiding/guided_pixels.h"
#include "infer/renderer/renderer.h"
#include "infer/tool/picture_size.h"
#include "infer/tool/tool_options.h"
#include "lte/base/check.h"
#include "lte/cli/numbers.h"
#include "lte/cli/scene_flags.h"
#include "lte/pathtrace/placement/auto_camera.h"

namespace lte::experiments {
namespace {

struct Request {
  std::string scene, checkpoint, size = "320x240";
  GuidingOptions options;
  SceneFlags loading;
  CommonOptions common;
};

void add_options(CLI::App& app, Request* request) {
  GuidingOptions& options = request->options;
  app.add_option("SCENE", request->scene, "Scene")->required();
  app.add_option("--checkpoint", request->checkpoint, "Model with a radiance decoder")->required();
  app.add_option("--size", request->size, "Size of the picture whose pixels share maps")
      ->check(CLI::Validator(infer::check_picture_size, "WxH"))
      ->capture_default_str();
  app.add_option("--columns", options.columns, "Pixels measured in a row")
      ->check(positive_number())
      ->capture_default_str();
  app.add_option("--rows", options.rows, "Rows of measured pixels")
      ->check(positive_number())
      ->capture_default_str();
  app.add_option("--paths", options.paths, "Paths a measured pixel")
      ->check(positive_number())
      ->capture_default_str();
  app.add_option("--points", options.query_points,
                 "Points over the surfaces, of which each sixteenth is measured")
      ->check(positive_number())
      ->capture_default_str();
  app.add_option("--radius", options.radius_m, "Metres from a shared map's point at most")
      ->check(positive_number())
      ->capture_default_str();
  add_scene_flags(app, &request->loading);
  add_common_options(app, &request->common);
}

std::vector<bench::BenchResult> measure(const Request& request) {
  const scene::Scene scene = load_scene(request.scene, request.loading);
  const runtime::Network network(request.checkpoint);
  LTE_CHECK(network.config().predicts_radiance(), request.checkpoint,
            ": has no radiance decoder (its model.radiance_lobes is 0)");
  infer::Renderer renderer(scene);
  infer::EmbedSettings embedding;
  embedding.rescale = true;
  renderer.embed(network, embedding);
  const scene::Camera camera =
      scene.cameras.empty() ? pathtrace::auto_camera(renderer.bvh()) : scene.cameras.front();
  GuidingOptions options = request.options;
  std::tie(options.width, options.height) = infer::parse_picture_size(request.size);
  std::vector<GuidingRow> rows = guided_pixels(renderer, camera, options);
  for (const GuidingRow& row : guided_irradiance(renderer, options)) rows.push_back(row);
  std::vector<bench::BenchResult> out;
  for (const GuidingRow& row : rows)
    out.push_back({row.name, row.paths, row.seconds, row.seconds, row.figures});
  return out;
}

void run(const Request& request) {
  CommandFiles files;
  files.reads("SCENE", request.scene);
  files.reads("--checkpoint", request.checkpoint);
  bench::run_measured(request.common, &files, [&] { return measure(request); });
}

}  // namespace

std::function<void()> add_command(CLI::App* app) {
  const auto request = std::make_shared<Request>();
  app->name("experiment_guiding");
  app->description("Variance of indirect light by paths that a radiance decoder guides.");
  add_options(*app, request.get());
  return [request] { run(*request); };
}

}  // namespace lte::experiments
