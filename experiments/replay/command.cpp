// Rays of the path tracer, replayed through each of Embree's entry points and nothing else: what
// the path tracer itself costs.
#include "experiments/command.h"

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "bench/begin_command.h"
#include "bench/bench.h"
#include "experiments/replay/trace_rates.h"
#include "infer/tool/tool_options.h"
#include "lte/base/parallel.h"
#include "lte/cli/assets.h"
#include "lte/cli/numbers.h"
#include "lte/cli/scene_flags.h"
#include "lte/scene/sampler.h"

namespace lte::experiments {
namespace {

struct Request {
  std::string scene;
  int64_t points = 2'000;
  int paths = 256;
  double seconds = 1;
  SceneFlags loading;
  CommonOptions common;
};

void add_options(CLI::App& app, Request* request) {
  app.add_option("SCENE", request->scene, "Scene (default: the shipped Cornell box)");
  app.add_option("--points", request->points, "Points over the surfaces")
      ->check(positive_number())
      ->capture_default_str();
  app.add_option("--paths", request->paths, "Paths a point")
      ->check(positive_number())
      ->capture_default_str();
  app.add_option("--seconds", request->seconds, "Least time of each entry point")
      ->check(positive_number())
      ->capture_default_str();
  add_scene_flags(app, &request->loading);
  add_common_options(app, &request->common);
}

std::vector<bench::BenchResult> measure(const Request& request) {
  const scene::Scene scene =
      load_scene(request.scene.empty() ? asset_path("scenes/cornell_box.glb", "SCENE")
                                       : std::filesystem::path(request.scene),
                 request.loading);
  const pathtrace::Bvh bvh(scene);
  const pathtrace::Lights lights(scene);
  const scene::SurfaceSamples points = scene::sample_surface(scene, request.points, {.seed = 7});
  pathtrace::IrradianceOptions tracing;
  tracing.rays = request.paths;
  const TraceRates rates =
      measure_trace_rates(bvh, lights, points.position, points.normal, tracing, request.seconds);
  std::vector<bench::BenchResult> results;
  const auto add = [&](const std::string& name, double rays_per_s, int64_t stopped) {
    const double seconds = static_cast<double>(rates.rays) / rays_per_s;
    bench::BenchResult row{name, rates.rays, seconds, seconds, {}};
    row.figures["mrays_per_s"] = 1e-6 * rays_per_s;
    row.figures["threads"] = num_threads();
    if (stopped >= 0) row.figures["stopped"] = static_cast<double>(stopped);
    results.push_back(row);
  };
  add("path tracer", rates.path_rays_per_s, -1);
  for (const BareRate& rate : rates.bare) {
    add("bare " + rate.entry_point + (rate.sorted ? ", sorted" : ""), rate.rays_per_s,
        rate.stopped);
    results.back().figures["share_of_path_tracer"] = rates.path_rays_per_s / rate.rays_per_s;
  }
  return results;
}

void run(const Request& request) {
  CommandFiles files;
  files.reads("SCENE", request.scene);
  bench::run_measured(request.common, &files, [&] { return measure(request); });
}

}  // namespace

std::function<void()> add_command(CLI::App* app) {
  const auto request = std::make_shared<Request>();
  app->name("experiment_replay");
  app->description("The path tracer beside bare Embree calls on the same rays.");
  add_options(*app, request.get());
  return [request] { run(*request); };
}

}  // namespace lte::experiments
