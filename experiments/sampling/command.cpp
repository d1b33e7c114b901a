// What the path tracer's sampling saves: error with and without it, and paths at equal error, as
// Markdown tables.
#include "experiments/command.h"

#include <cstdio>
#include <ctime>
#include <functional>
#include <memory>
#include <numeric>

#include <CLI/CLI.hpp>

#include "experiments/sampling/error_gain.h"
#include "lte/cli/cli.h"
#include "lte/pathtrace/irradiance.h"
#include "lte/scene/load.h"
#include "lte/scene/sampler.h"
#include "tests/support/scenes.h"

namespace lte::experiments {

using namespace pathtrace;

namespace {

struct Flags {
  std::vector<std::string> scenes;
  GainOptions gain;
  int64_t points = 64;
  bool roulette = false;
  int64_t roulette_points = 1000;
};

using Measure = std::vector<ErrorGain> (*)(const Bvh&, std::span<const Vec3>, std::span<const Vec3>,
                                           const GainOptions&);

void table(const scene::Scene& scene, const Flags& flags, const char* what, Measure measure) {
  const Bvh bvh(scene);
  const scene::SurfaceSamples samples =
      scene::sample_surface(scene, flags.points, {.seed = 3, .punctual_lights = false});
  for (const ErrorGain& row : measure(bvh, samples.position, samples.normal, flags.gain)) {
    std::printf("| %s | %s | %lld | %.2f | %.2f | %.2f |\n", what, scene.name.c_str(),
                static_cast<long long>(row.rays), 100 * row.rmse_before, 100 * row.rmse_after,
                row.rays_ratio);
    std::fflush(stdout);
  }
}

struct Cost {
  double seconds = 0, rays = 0, variance = 0;  ///< sums over seeds; variance of indirect irradiance
};

Cost measure_roulette(const Bvh& bvh, const Lights& lights, const scene::SurfaceSamples& points,
                      int max_depth, int roulette_depth, const Flags& flags) {
  Cost cost;
  for (int seed = 0; seed < flags.gain.repeats; ++seed) {
    IrradianceOptions options;
    options.rays = 256;
    options.max_depth = max_depth;
    options.roulette_depth = roulette_depth;
    options.seed = static_cast<uint64_t>(seed);
    const std::clock_t start = std::clock();
    const Irradiance light =
        estimate_irradiance(bvh, lights, points.position, points.normal, options);
    cost.seconds += static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    cost.rays += static_cast<double>(light.rays_traced);
    cost.variance += std::accumulate(light.variance.begin(), light.variance.end(), 0.0);
  }
  return cost;
}

/// Russian roulette from each vertex on, beside paths that all go on to the last hit.
void roulette(const scene::Scene& scene, const Flags& flags) {
  const Bvh bvh(scene);
  const Lights lights(scene);
  const scene::SurfaceSamples points =
      scene::sample_surface(scene, flags.roulette_points, {.seed = 7});
  for (const int max_depth : {5, 16}) {
    const Cost without = measure_roulette(bvh, lights, points, max_depth, max_depth, flags);
    for (const int from : {1, 2, 3}) {
      const Cost with = measure_roulette(bvh, lights, points, max_depth, from, flags);
      const double seconds = with.seconds / without.seconds,
                   variance = with.variance / without.variance;
      std::printf("| %s | %d | %d | %.2f | %.2f | %.2f | %.2f |\n", scene.name.c_str(), max_depth,
                  from, with.rays / without.rays, seconds, variance, 1 / (seconds * variance));
      std::fflush(stdout);
    }
  }
}

void run_roulette(const Flags& flags) {
  std::puts(
      "| scene | depth | roulette from vertex | rays | processor time | variance | gain at equal "
      "error |\n|---|---:|---:|---:|---:|---:|---:|");
  for (const std::string& path : flags.scenes) roulette(scene::load_scene(path), flags);
}

void run(const Flags& flags) {
  if (flags.roulette) return run_roulette(flags);
  std::puts(
      "| gain of | scene | rays | RMSE without, % | RMSE with, % | rays ratio |\n"
      "|---|---|---|---|---|---|");
  const scene::Scene hall = test::hall_of_lamps();
  table(hall, flags, "light tree", measure_light_tree);
  for (const std::string& path : flags.scenes) {
    const scene::Scene scene = scene::load_scene(path);
    table(scene, flags, "light tree", measure_light_tree);
    table(scene, flags, "stratification", measure_stratification);
  }
}

void add_options(CLI::App& app, Flags* flags) {
  app.add_option("scenes", flags->scenes, "Scenes: .gltf or .glb");
  app.add_option("--rays", flags->gain.rays, "Paths a point to compare at")->capture_default_str();
  app.add_option("--points", flags->points, "Points over the surfaces")->capture_default_str();
  app.add_option("--repeats", flags->gain.repeats, "Runs with other seeds")->capture_default_str();
  app.add_flag("--roulette", flags->roulette, "What Russian roulette saves instead");
  app.add_option("--roulette-points", flags->roulette_points,
                 "Points of --roulette, 256 paths each")
      ->capture_default_str();
  app.add_option("--reference-rays", flags->gain.reference_rays)->capture_default_str();
}

}  // namespace

std::function<void()> add_command(CLI::App* app) {
  const auto request = std::make_shared<Flags>();
  app->name("experiment_sampling");
  app->description("Measures what the path tracer's sampling saves.");
  add_options(*app, request.get());
  return [request] { run(*request); };
}

}  // namespace lte::experiments
