#include "infer/bench/bench_command.h"

#include <cstdio>

#include "infer/common/tool_options.h"
#include "lte/base/file.h"
#include "lte/cli/command_files.h"
#include "lte/cli/numbers.h"
#include "lte/runtime/device.h"

#ifndef LTE_HAS_SCENE
#define LTE_HAS_SCENE 0
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
  add("ops", "Every operator alone", bench_ops);
  for (CLI::App* command : {add("encoder", "Scene points to embedding", bench_encoder),
                            add("decoder", "Query points to irradiance", bench_decoder)})
    add_network_options(*command, &options.precision, &options.max_memory_mb);
#if LTE_HAS_SCENE
  CLI::App* pathtrace = add("pathtrace", "Path tracing against bare Embree calls", bench_pathtrace);
  CLI::App* pareto = add("pareto", "Run time against error, beside path tracing", bench_pareto);
  for (CLI::App* command : {pathtrace, pareto}) {
    command->add_option("--scene", options.scene, "Scene (default: the shipped Cornell box)");
    add_scene_flags(*command, &options.loading);
  }
  pareto->add_option("--checkpoint", options.checkpoint, "Model (default: the shipped one)");
  pareto->add_option("--reference-rays", options.reference_rays, "Rays a pixel of the reference");
#endif
  app.require_subcommand(1);
}

void run_bench(const BenchRequest& request) {
  CommandFiles files;
  files.reads("--scene", request.options.scene);
  files.reads("--checkpoint", request.options.checkpoint);
  files.writes_common(request.common);
  files.check();
  apply_common_options(request.common);
  runtime::set_torch_threads(request.common.threads);
  const std::vector<BenchResult> results = request.benchmark(request.options);
  std::fputs(bench_table(results).c_str(), stdout);
  files.check_what_was_read();
  if (!request.common.json.empty()) write_file(request.common.json, bench_json(results));
}

}  // namespace lte::infer
