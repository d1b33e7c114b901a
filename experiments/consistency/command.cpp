// Change of light between frames of a moving camera, beside path tracing.
#include "experiments/command.h"

#include <cstdio>
#include <functional>
#include <memory>
#include <string>
#include <tuple>

#include <nlohmann/json.hpp>

#include "bench/begin_command.h"
#include "bench/pareto/pareto.h"
#include "experiments/consistency/consistency.h"
#include "infer/tool/picture_size.h"
#include "infer/tool/tool_options.h"
#include "lte/base/check.h"
#include "lte/base/file.h"
#include "lte/cli/assets.h"
#include "lte/cli/scene_flags.h"
#include "lte/embed/untrained_light.h"
#include "lte/scene/load_camera.h"

namespace lte::experiments {

using namespace infer;

namespace {

struct Request {
  std::string scene, checkpoint, camera;  ///< empty: as the help says
  std::string size = "160x120";
  ConsistencyOptions options;
  SceneFlags loading;
  CommonOptions common;
};

nlohmann::json flicker_json(const Flicker& flicker) {
  return {{"pixels", flicker.pixels},
          {"compared", flicker.compared},
          {"level", flicker.level},
          {"change", flicker.change}};
}

nlohmann::json consistency_json(const ConsistencyOptions& options, const Consistency& result) {
  nlohmann::json json = {{"size", {options.width, options.height}},
                         {"frames", options.frames},
                         {"degrees", options.degrees},
                         {"points", result.points},
                         {"answers", result.answers},
                         {"largest_change", result.largest_change},
                         {"denoiser", result.denoiser},
                         {"rows", nlohmann::json::array()}};
  for (const ConsistencyRow& row : result.rows) {
    json["rows"].push_back({{"name", row.name},
                            {"indirect", flicker_json(row.indirect)},
                            {"total", flicker_json(row.total)}});
  }
  return json;
}

void print_consistency(const ConsistencyOptions& options, const Consistency& result) {
  std::printf(
      "%d frames of %dx%d; %lld surface points, asked again %lld times: the network's "
      "answers change by %g W/m2 at most\n",
      options.frames, options.width, options.height, static_cast<long long>(result.points),
      static_cast<long long>(result.answers), result.largest_change);
  std::printf("%-46s %9s %9s\n", "change between frames over the mean", "indirect", "total");
  for (const ConsistencyRow& row : result.rows)
    std::printf("%-46s %9.4f %9.4f\n", row.name.c_str(), row.indirect.change, row.total.change);
  std::printf("denoised by %s\n", result.denoiser.c_str());
}

void add_options(CLI::App& command, Request* request) {
  ConsistencyOptions& options = request->options;
  command.add_option("SCENE", request->scene, "Scene file (default: the shipped living room)");
  command.add_option("--checkpoint", request->checkpoint, "Model; by default the shipped one");
  command.add_option(
      "--camera", request->camera,
      concat("The first: ", scene::kCameraHelp, "; by default the scene's first, else auto"));
  command.add_option("--size", request->size, "Size of a frame")
      ->check(CLI::Validator(check_picture_size, "WxH"))
      ->capture_default_str();
  command.add_option("--frames", options.frames, "Frames of the camera's path")
      ->check(CLI::Range(2, 10'000))
      ->capture_default_str();
  command.add_option("--degrees", options.degrees, "How far the camera turns on its path")
      ->check(CLI::Range(0.1, 360.0))
      ->capture_default_str();
  command.add_option("--spp", options.spp, "Paths a pixel of the path-traced frames")
      ->check(CLI::Range(1, 1 << 20))
      ->capture_default_str();
  command.add_option("--max-depth", options.max_depth, "Surface hits of these paths")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command.add_option("--seed", options.seed, "Seed of the first frame; each has the next")
      ->capture_default_str();
  add_scene_flags(command, &request->loading);
  add_common_options(command, &request->common);
}

void run(const Request& request) {
  ConsistencyOptions options = request.options;
  std::tie(options.width, options.height) = parse_picture_size(request.size);
  CommandFiles files;
  files.reads("SCENE", request.scene);
  files.reads("--checkpoint", request.checkpoint);
  bench::begin_command(request.common, &files);
  const scene::Scene scene =
      load_scene(request.scene.empty() ? asset_path("scenes/living_room.glb", "SCENE")
                                       : std::filesystem::path(request.scene),
                 request.loading);
  Renderer renderer(scene);
  LTE_CHECK(renderer.has_light(), scene.name, ": nothing emits light");
  const float aspect = static_cast<float>(options.width) / static_cast<float>(options.height);
  const scene::Camera first =
      bench::pareto_views(renderer.bvh(), request.camera, 1, aspect).front();
  const runtime::Network network(checkpoint_or_shipped(request.checkpoint));
  LTE_CHECK(!embed::has_untrained_light(scene, network.metadata()), scene.name,
            ": the model knows no light from outside, so there is nothing of it to measure");
  EmbedSettings embedding;
  embedding.rescale = true;
  renderer.embed(network, embedding);
  files.check_what_was_read();
  const Consistency result =
      measure_consistency(&renderer, consistency_cameras(renderer.bvh(), first, options), options);
  print_consistency(options, result);
  if (!request.common.json.empty())
    write_file(request.common.json, consistency_json(options, result).dump(2) + '\n');
}

}  // namespace

std::function<void()> add_command(CLI::App* app) {
  const auto request = std::make_shared<Request>();
  app->name("experiment_consistency");
  app->description("Change of light between frames of a moving camera, beside path tracing.");
  add_options(*app, request.get());
  return [request] { run(*request); };
}

}  // namespace lte::experiments
