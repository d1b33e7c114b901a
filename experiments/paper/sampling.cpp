// experiment_paper sampling: what a network answers from scene points that are drawn in one way or
// another, at the query points of a data set that was generated with --glb.
#include <cmath>
#include <cstdio>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "experiments/paper/commands.h"
#include "experiments/paper/point_draw.h"
#include "experiments/paper/trial.h"
#include "experiments/paper/view_scores.h"
#include "infer/eval/measure/bootstrap.h"
#include "infer/eval/measure/eval_points.h"
#include "lte/base/check.h"
#include "lte/embed/scene_points.h"
#include "lte/image/metrics.h"
#include "lte/runtime/embedding.h"
#include "lte/scene/load.h"

namespace lte::experiments {
namespace {

struct SamplingTrial : Trial {
  int64_t candidates = 65'536, points = 0;
};

/// Mean squared error at a scene's query points, over the emission scalar squared.
double error_of(const EvalScene& scene, const runtime::Network& network,
                const scene::SurfaceSamples& points) {
  const runtime::SceneEmbedding embedding(network,
                                          {points.position,
                                           points.normal,
                                           points.albedo,
                                           points.emission,
                                           points.area,
                                           {},
                                           {},
                                           {},
                                           {},
                                           {},
                                           {}},
                                          {});
  const infer::EvalPoints queries = infer::query_eval_points(scene.sample, scene.radiance);
  std::vector<Rgb> answer = embedding.decode(queries.queries);
  for (Rgb& value : answer) value = value * static_cast<float>(1 / scene.radiance);
  return image::mse(runtime::floats(answer), runtime::floats(queries.reference));
}

void run(const SamplingTrial& request) {
  begin_trial(request);
  const runtime::Network network(request.checkpoint);
  LTE_CHECK(network.light_request().depth == 0, request.checkpoint,
            ": reads path-traced light, which points that are drawn anew lack");
  const std::vector<EvalScene> scenes = read_eval_scenes(request.data, data::Split::Test);
  const int64_t count = request.points > 0 ? request.points : network.metadata().scene_points;
  const auto& draws = enum_names(PointDraw{});
  std::vector<std::vector<double>> errors(draws.size());
  std::vector<double> drawn(draws.size(), 0);
  for (const EvalScene& eval : scenes) {
    const scene::Scene scene =
        scene::load_scene(std::filesystem::path(eval.path).replace_extension(".glb"));
    const pathtrace::Bvh bvh(scene);
    const pathtrace::Lights lights(scene);
    const scene::SurfaceSamples candidates = embed::sample_scene_points(
        bvh, request.candidates, network.metadata().scene_points_pruned, request.seed, nullptr);
    for (size_t i = 0; i < draws.size(); ++i) {
      const scene::SurfaceSamples points =
          draw_points(static_cast<PointDraw>(i), bvh, lights, candidates, count, request.seed);
      drawn[i] += static_cast<double>(points.size()) / static_cast<double>(scenes.size());
      errors[i].push_back(error_of(eval, network, points));
    }
  }
  const infer::Bootstrap bootstrap(scenes.size(), {});
  nlohmann::json rows = nlohmann::json::array();
  for (size_t i = 0; i < draws.size(); ++i) {
    const auto mean = [&](std::span<const uint32_t> picks, size_t of) {
      double sum = 0;
      for (const uint32_t k : picks) sum += errors[of][k];
      return sum;
    };
    const infer::Interval ratio = bootstrap.interval(
        [&](std::span<const uint32_t> picks) { return mean(picks, i) / mean(picks, 0); });
    const double mse = infer::mean_of(errors[i]);
    rows.push_back({{"draw", draws[i].name},
                    {"scenes", scenes.size()},
                    {"points", drawn[i]},
                    {"mse", mse},
                    {"ratio", mse / infer::mean_of(errors[0])},
                    {"ratio_interval", {ratio.low, ratio.high}}});
    std::printf("%s: MSE %.4g, %.3f of even points\n", draws[i].name, mse,
                rows.back()["ratio"].get<double>());
  }
  write_report(request, std::move(rows));
}

void add_flags(CLI::App& command, SamplingTrial* request) {
  add_data_option(command, request, "Data set generated with --glb; its test split");
  command.add_option("--checkpoint", request->checkpoint, "Model (.safetensors)")->required();
  add_count(command, "--candidates", &request->candidates, 1, "Points by area that are drawn from");
  add_count(command, "--points", &request->points, 0, "Drawn; 0: as many as in training");
}

}  // namespace

std::function<void()> add_sampling(CLI::App* app) {
  return add_trial<SamplingTrial>(
      app, "sampling", "Compare ways to draw scene points by a network's error from them",
      add_flags, run);
}

}  // namespace lte::experiments
