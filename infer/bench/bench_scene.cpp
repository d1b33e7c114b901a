// lte_bench pathtrace: what needs a scene and Embree.
#include "infer/bench/bench.h"
#include "infer/bench/trace_rates.h"
#include "infer/tool/assets.h"
#include "lte/base/parallel.h"
#include "lte/base/process_memory.h"
#include "lte/cli/scene_flags.h"
#include "lte/pathtrace/irradiance.h"
#include "lte/scene/sampler.h"

namespace lte::infer {
namespace {

scene::Scene load_benchmark_scene(const BenchOptions& options) {
  return load_scene(options.scene.empty() ? asset_path("scenes/cornell_box.glb", "--scene")
                                          : std::filesystem::path(options.scene),
                    options.loading);
}

}  // namespace

std::vector<BenchResult> bench_pathtrace(const BenchOptions& options) {
  const scene::Scene scene = load_benchmark_scene(options);
  const pathtrace::Bvh bvh(scene);
  const pathtrace::Lights lights(scene);
  const scene::SurfaceSamples points = scene::sample_surface(scene, 2'000, {.seed = 7});
  pathtrace::IrradianceOptions tracing;
  tracing.rays = 256;
  const TraceRates rates =
      measure_trace_rates(bvh, lights, points.position, points.normal, tracing);
  std::vector<BenchResult> results;
  const auto add = [&](const std::string& name, double rays_per_s) {
    const double seconds = static_cast<double>(rates.rays) / rays_per_s;
    BenchResult row{name, rates.rays, seconds, seconds, {}};
    row.figures["mrays_per_s"] = 1e-6 * rays_per_s;
    row.figures["threads"] = num_threads();
    results.push_back(row);
  };
  add("pathtrace irradiance", rates.path_rays_per_s);
  results.back().figures["peak_rss_mb"] = peak_rss_mb();
  for (const BareRate& rate : rates.bare) {
    add("bare " + rate.entry_point + (rate.sorted ? ", sorted" : ""), rate.rays_per_s);
    results.back().figures["share_of_pathtrace"] = rates.path_rays_per_s / rate.rays_per_s;
  }
  return results;
}

}  // namespace lte::infer
