#include "bench/bench_command.h"

#include <memory>

#include "bench/begin_command.h"
#include "infer/tool/tool_options.h"
#include "lte/cli/numbers.h"

#ifndef LTE_HAS_SCENE
#define LTE_HAS_SCENE 0
#endif
#if LTE_HAS_SCENE
#include "bench/pareto/pareto_command.h"
#endif
#if LTE_HAS_BAKE
#include "bench/bake_table.h"
#endif

namespace lte::bench {

using namespace infer;

void add_bench_options(CLI::App& app, BenchRequest* request) {
  BenchOptions& options = request->options;
  add_common_options(app, &request->common);
  app.add_option("--repeats", options.repeats, "Timed runs after the warm-up; the least counts")
      ->check(positive_number())
      ->capture_default_str();
  const char* const sizes = "Sizes of ops, encoder and decoder";
  app.add_option("--channels", options.channels, "D of the network")
      ->check(positive_number())
      ->capture_default_str()
      ->group(sizes);
  app.add_option("--scene-points", options.scene_points, "M")
      ->check(positive_number())
      ->capture_default_str()
      ->group(sizes);
  app.add_option("--queries", options.queries, "Query points")
      ->check(positive_number())
      ->capture_default_str()
      ->group(sizes);
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
        add("decoder", "Query points to irradiance and to radiance", bench_decoder)}) {
    add_device(command);
    add_network_options(*command, &options.precision, &options.max_memory_mb);
  }
#if LTE_HAS_SCENE
  CLI::App* pathtrace = add("pathtrace", "Rays a second of path tracing", bench_pathtrace);
  pathtrace->add_option("--scene", options.scene, "Scene (default: the shipped Cornell box)");
  add_scene_flags(*pathtrace, &options.loading);
  CLI::App* pareto = app.add_subcommand("pareto", "Run time against error of every method");
  const auto chart = std::make_shared<ParetoRequest>();
  add_pareto_options(*pareto, chart.get());
  pareto->fallthrough()->callback([request, chart] {
    request->command = [request, chart] {
      run_pareto(*chart, request->options.repeats, request->common);
    };
  });
#endif
#if LTE_HAS_BAKE
  CLI::App* bake = app.add_subcommand("bake", "Seconds against error of light maps");
  const auto table = std::make_shared<BakeTableRequest>();
  add_bake_table_options(*bake, table.get());
  bake->fallthrough()->callback([request, table] {
    request->command = [request, table] { run_bake_table(*table, request->common); };
  });
#endif
  app.require_subcommand(1);
}

void run_bench(const BenchRequest& request) {
  if (request.command) return request.command();
  CommandFiles files;
  files.reads("--scene", request.options.scene);
  run_measured(request.common, &files, [&] { return request.benchmark(request.options); });
}

}  // namespace lte::bench
