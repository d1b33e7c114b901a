// lte_bench pathtrace: what needs a scene and Embree.
#include <algorithm>
#include <cmath>

#include "bench/bench.h"
#include "lte/base/parallel.h"
#include "lte/base/process_memory.h"
#include "lte/base/timer.h"
#include "lte/cli/assets.h"
#include "lte/cli/scene_flags.h"
#include "lte/pathtrace/irradiance.h"
#include "lte/scene/sampler.h"

namespace lte::bench {

std::vector<BenchResult> bench_pathtrace(const BenchOptions& options) {
  const scene::Scene scene =
      load_scene(options.scene.empty() ? asset_path("scenes/cornell_box.glb", "--scene")
                                       : std::filesystem::path(options.scene),
                 options.loading);
  const pathtrace::Bvh bvh(scene);
  const pathtrace::Lights lights(scene);
  const scene::SurfaceSamples points = scene::sample_surface(scene, 2'000, {.seed = 7});
  pathtrace::IrradianceOptions tracing;
  tracing.rays = 256;
  int64_t rays = 0;
  double least_s = INFINITY;
  const auto trace = [&] {
    const double begin = processor_seconds();
    rays = pathtrace::estimate_irradiance(bvh, lights, points.position, points.normal, tracing)
               .rays_traced;
    least_s = std::min(least_s, (processor_seconds() - begin) / num_threads());
  };
  BenchResult row = time_repeats("pathtrace irradiance", points.size(), options.repeats, trace);
  row.n = rays;
  // By the processor time of a thread, which other work on the machine does not lengthen.
  row.figures["mrays_per_s"] = 1e-6 * static_cast<double>(rays) / std::max(least_s, 1e-9);
  row.figures["threads"] = num_threads();
  return {row};
}

}  // namespace lte::bench
