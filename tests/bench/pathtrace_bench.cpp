// What the path tracer's sampling saves: error with and without it, and paths at equal error, as
// Markdown tables.
#include <cstdio>

#include <CLI/CLI.hpp>

#include "lte/base/cli.h"
#include "lte/pathtrace/benchmark.h"
#include "lte/scene/load.h"
#include "lte/scene/sampler.h"
#include "tests/support/scenes.h"

namespace lte::pathtrace {
namespace {

struct Flags {
  std::vector<std::string> scenes;
  GainOptions gain;
  int64_t points = 64;
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

void run(const Flags& flags) {
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

}  // namespace
}  // namespace lte::pathtrace

int main(int argc, char** argv) {
  CLI::App app{"Measures what the path tracer's sampling saves.", "lte_pathtrace_microbench"};
  lte::pathtrace::Flags flags;
  app.add_option("scenes", flags.scenes, "Scenes: .gltf or .glb");
  app.add_option("--rays", flags.gain.rays, "Paths a point to compare at")->capture_default_str();
  app.add_option("--points", flags.points, "Points over the surfaces")->capture_default_str();
  app.add_option("--repeats", flags.gain.repeats, "Runs with other seeds")->capture_default_str();
  app.add_option("--reference-rays", flags.gain.reference_rays)->capture_default_str();
  return lte::run_tool(app, argc, argv, [&flags] { lte::pathtrace::run(flags); });
}
