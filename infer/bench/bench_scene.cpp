// lte_bench pathtrace and pareto: what needs a scene and Embree.
#include "infer/bench/bench.h"
#include "infer/bench/trace_rates.h"
#include "infer/common/assets.h"
#include "infer/common/lit_samples.h"
#include "infer/common/renderer.h"
#include "infer/common/untrained_light.h"
#include "lte/base/check.h"
#include "lte/base/log.h"
#include "lte/base/parallel.h"
#include "lte/base/process_memory.h"
#include "lte/base/timer.h"
#include "lte/cli/scene_flags.h"
#include "lte/image/metrics.h"
#include "lte/pathtrace/auto_camera.h"
#include "lte/pathtrace/irradiance.h"
#include "lte/pathtrace/render.h"
#include "lte/scene/sampler.h"

namespace lte::infer {
namespace {

/// The visible, reflecting surface points of a view.
struct VisiblePoints {
  std::vector<Vec3> position, normal, albedo;
};

VisiblePoints visible_points(const pathtrace::Bvh& bvh, int width, int height) {
  const pathtrace::GBuffer view =
      pathtrace::trace_gbuffer(bvh, pathtrace::auto_camera(bvh), width, height);
  VisiblePoints points;
  for (size_t i = 0; i < view.mask.size(); ++i) {
    if (!view.mask[i] || max_component(view.albedo[i]) <= 0) continue;
    points.position.push_back(view.position[i]);
    points.normal.push_back(view.normal[i]);
    points.albedo.push_back(view.albedo[i]);
  }
  LTE_CHECK(!points.position.empty(), "the automatic camera sees no reflecting surface");
  return points;
}

scene::Scene load_benchmark_scene(const BenchOptions& options) {
  return load_scene(options.scene.empty() ? asset_path("scenes/cornell_box.glb", "--scene")
                                          : std::filesystem::path(options.scene),
                    options.loading);
}

std::vector<float> indirect_values(const pathtrace::Irradiance& irradiance) {
  std::vector<float> values;
  for (int64_t i = 0; i < irradiance.points; ++i) {
    const Rgb e = irradiance.indirect_sum(i);
    values.insert(values.end(), {e.x, e.y, e.z});
  }
  return values;
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

std::vector<BenchResult> bench_pareto(const BenchOptions& options) {
  const scene::Scene scene = load_benchmark_scene(options);
  const pathtrace::Bvh bvh(scene);
  const pathtrace::Lights lights(scene);
  const VisiblePoints view = visible_points(bvh, options.width, options.height);
  const auto pixels = static_cast<int64_t>(view.position.size());
  pathtrace::IrradianceOptions tracing;
  tracing.seed = 1;
  tracing.rays = options.reference_rays;
  const std::vector<float> reference = indirect_values(
      pathtrace::estimate_irradiance(bvh, lights, view.position, view.normal, tracing));
  std::vector<BenchResult> results;
  const auto add = [&](const std::string& name, double seconds, std::span<const float> values) {
    BenchResult row{name, pixels, seconds, seconds, {}};
    row.figures["mse"] = image::mse(values, reference);
    row.figures["relmse"] = image::relative_mse(values, reference);
    results.push_back(row);
  };
  for (const int rays : {1, 4, 16, 64, 256, 1024}) {
    tracing.seed = 2;
    tracing.rays = rays;
    const Timer timer;
    const pathtrace::Irradiance traced =
        pathtrace::estimate_irradiance(bvh, lights, view.position, view.normal, tracing);
    add("path tracing " + std::to_string(traced.rays) + " rays", timer.seconds(),
        indirect_values(traced));
  }
  const runtime::Network network(checkpoint_or_shipped(options.checkpoint));
  const std::string note = untrained_light_note(scene, network.metadata());
  if (!note.empty()) log_warning(note);
  const QueryPoints queries{view.position, view.normal, view.albedo};
  for (const int64_t count : {2'048, 4'096, 8'192, 20'000}) {
    const auto sample = [&] {
      const bool prune = network.metadata().scene_points_pruned;
      scene::SurfaceSamples samples = sample_scene_points(bvh, count, prune, /*seed=*/0, nullptr);
      leave_out_untrained_suns(bvh.scene(), network.metadata(), &samples);
      return samples;
    };
    const auto encode = [&](scene::SurfaceSamples samples) {
      const LitSamples lit =
          add_light_estimates(bvh, lights, std::move(samples), network.light_request(), /*seed=*/0);
      return runtime::SceneEmbedding(network, lit.points());
    };
    encode(sample()).decode(queries);  // warm-up
    const Timer timer;
    scene::SurfaceSamples samples = sample();
    const double sample_seconds = timer.seconds();
    const runtime::SceneEmbedding embedding = encode(std::move(samples));
    const double embed_seconds = timer.seconds();
    const std::vector<Rgb> predicted = embedding.decode(queries);
    add("lte M = " + std::to_string(count), timer.seconds(), floats(predicted));
    results.back().figures["sample_seconds"] = sample_seconds;
    results.back().figures["encode_seconds"] = embed_seconds - sample_seconds;
  }
  return results;
}

}  // namespace lte::infer
