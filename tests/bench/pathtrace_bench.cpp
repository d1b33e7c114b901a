// What the path tracer's sampling saves: error and rays with and without it, as Markdown tables.
#include <cstdio>

#include <CLI/CLI.hpp>

#include "lte/base/cli.h"
#include "lte/pathtrace/benchmark.h"
#include "lte/scene/load.h"
#include "lte/scene/sampler.h"

namespace lte::pathtrace {
namespace {

struct Flags {
  std::vector<std::string> scenes;
  std::vector<int> rays{64, 256, 1024};
  int64_t points = 64;
  int repeats = 12, reference_rays = 1 << 14;
};

void stratification(const Flags& flags) {
  std::puts(
      "| scene | rays | RMSE random, % | RMSE stratified, % | rays ratio |\n|---|---|---|---|---|");
  for (const std::string& path : flags.scenes) {
    const scene::Scene scene = scene::load_scene(path);
    const Bvh bvh(scene);
    const Lights lights(scene);
    const scene::SurfaceSamples samples =
        scene::sample_surface(scene, flags.points, {.seed = 3, .punctual_lights = false});
    for (const SamplingError& row :
         measure_sampling(bvh, lights, samples.position, samples.normal, {}, flags.rays,
                          flags.reference_rays, flags.repeats)) {
      std::printf("| %s | %lld | %.2f | %.2f | %.2f |\n", scene.name.c_str(),
                  static_cast<long long>(row.rays), 100 * row.rmse_random,
                  100 * row.rmse_stratified, row.rays_ratio);
    }
  }
}

}  // namespace
}  // namespace lte::pathtrace

int main(int argc, char** argv) {
  CLI::App app{"Measures what the path tracer's sampling saves.", "lte_pathtrace_microbench"};
  lte::pathtrace::Flags flags;
  app.add_option("scenes", flags.scenes, "Scenes: .gltf or .glb")->required();
  app.add_option("--rays", flags.rays, "Paths a point to compare at")->capture_default_str();
  app.add_option("--points", flags.points, "Points over the surfaces")->capture_default_str();
  app.add_option("--repeats", flags.repeats, "Runs with other seeds")->capture_default_str();
  app.add_option("--reference-rays", flags.reference_rays)->capture_default_str();
  return lte::run_tool(app, argc, argv, [&flags] { lte::pathtrace::stratification(flags); });
}
