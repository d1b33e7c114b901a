#include "infer/bench/bench_command.h"

#include <cstdio>
#include <memory>

#include "infer/tool/begin_command.h"
#include "infer/tool/picture_size.h"
#include "infer/tool/tool_options.h"
#include "lte/base/file.h"
#include "lte/cli/numbers.h"

#ifndef LTE_HAS_SCENE
#define LTE_HAS_SCENE 0
#endif
#if LTE_HAS_SCENE
#include "infer/bench/consistency_command.h"
#include "infer/bench/pareto/pareto_command.h"
#include "infer/bench/stability/stability_command.h"
#endif

namespace lte::infer {

void add_bench_options(CLI::App& app, BenchRequest* request) {
  BenchOptions& options = request->options;
  add_common_options(app, &request->common);
  app.add_option("--repeats", options.repeats, "Timed runs after the warm-up")
      ->check(positive_number());
  app.add_option("--channels", options.channels, "D of the network")->check(positive_number());
  app.add_option("--scene-points", options.scene_points, "M")->check(positive_number());
  app.add_option("--queries", options.queries, "Query points")->check(positive_number());
  const auto add = [&app, request](const char* name, const char* help, auto benchmark) {
    CLI::App* command = app.add_subcommand(name, help)->fallthrough();
    command->callback([request, benchmark] { request->benchmark = benchmark; });
    return command;
  };
  const auto add_device = [&options](CLI::App* command) {
    command->add_option("--device", options.device, "cpu or cuda")
        ->check(CLI::IsMember({"cpu", "cuda"}))
        ->capture_default_str();
  };
  add_device(add("ops", "Every operator alone", bench_ops));
  for (CLI::App* command :
       {add("encoder", "Scene points to embedding", bench_encoder),
        add("decoder", "Query points to irradiance", bench_decoder),
        add("radiance", "Query points to radiance by direction", bench_radiance)}) {
    add_device(command);
    add_network_options(*command, &options.precision, &options.max_memory_mb);
  }
#if LTE_HAS_SCENE
  CLI::App* pathtrace = add("pathtrace", "Path tracing against bare Embree calls", bench_pathtrace);
  pathtrace->add_option("--scene", options.scene, "Scene (default: the shipped Cornell box)");
  add_scene_flags(*pathtrace, &options.loading);
  CLI::App* edits =
      add("edits", "From an edit of a live scene to the picture after it", bench_edits);
  edits->add_option("--scene", options.scene, "Scene (default: the shipped living room)");
  edits->add_option("--random", options.random_edits,
                    "So many edits at random at the end; ends with 1 if memory grows");
  edits->add_option("--points", options.session_points, "Scene points (default: the model's)");
  add_scene_flags(*edits, &options.loading);
  CLI::App* guiding =
      add("guiding", "Variance of indirect light by paths that a radiance decoder guides",
          bench_guiding);
  guiding->add_option("--scene", options.scene, "Scene")->required();
  guiding->add_option("--checkpoint", options.checkpoint, "Model with a radiance decoder")
      ->required();
  guiding->add_option("--size", options.picture_size, "Size of the picture whose pixels share maps")
      ->check(CLI::Validator(check_picture_size, "WxH"))
      ->capture_default_str();
  guiding->add_option("--radius", options.radius_m, "Metres from a shared map's point at most")
      ->check(positive_number())
      ->capture_default_str();
  add_scene_flags(*guiding, &options.loading);
  CLI::App* pareto = app.add_subcommand("pareto", "Run time against error of every method");
  const auto chart = std::make_shared<ParetoRequest>();
  add_pareto_options(*pareto, chart.get());
  pareto->fallthrough()->callback([request, chart] {
    request->command = [chart](const CommonOptions& common) { run_pareto(*chart, common); };
  });
  CLI::App* stability = app.add_subcommand(
      "stability", "Finite answers, and how little they change, in scenes that strain numbers");
  const auto stress = std::make_shared<StabilityRequest>();
  add_stability_options(*stability, stress.get());
  stability->fallthrough()->callback([request, stress] {
    request->command = [stress](const CommonOptions& common) { run_stability(*stress, common); };
  });
  CLI::App* consistency = app.add_subcommand(
      "consistency", "Change of light between frames of a moving camera, beside path tracing");
  const auto frames = std::make_shared<ConsistencyRequest>();
  add_consistency_options(*consistency, frames.get());
  consistency->fallthrough()->callback([request, frames] {
    request->command = [frames](const CommonOptions& common) { run_consistency(*frames, common); };
  });
#endif
  app.require_subcommand(1);
}

void run_bench(const BenchRequest& request) {
  if (request.command) return request.command(request.common);
  CommandFiles files;
  files.reads("--scene", request.options.scene);
  files.reads("--checkpoint", request.options.checkpoint);
  begin_command(request.common, &files);
  const std::vector<BenchResult> results = request.benchmark(request.options);
  std::fputs(bench_table(results).c_str(), stdout);
  files.check_what_was_read();
  if (!request.common.json.empty()) write_file(request.common.json, bench_json(results));
}

}  // namespace lte::infer
