// lte_bench: times of every stage, and time against error.
#include "infer/bench/bench.h"
#include "infer/common/tool_options.h"
#include "lte/base/file.h"
#include "lte/cli/cli.h"
#include "lte/runtime/device.h"

#ifndef LTE_HAS_SCENE
#define LTE_HAS_SCENE 0
#endif

int main(int argc, char** argv) {
  using namespace lte;
  CLI::App app{"Measure run time, and run time against error.", "lte_bench"};
  app.footer(
      "Examples:\n  lte_bench decoder --json decoder.json\n  lte_bench pareto --scene room.glb");
  infer::BenchOptions options;
  CommonOptions common;
  add_common_options(app, &common);
  app.add_option("--repeats", options.repeats, "Timed runs after the warm-up")
      ->check(CLI::PositiveNumber);
  app.add_option("--channels", options.channels, "D of the network")->check(CLI::PositiveNumber);
  app.add_option("--scene-points", options.scene_points, "M")->check(CLI::PositiveNumber);
  app.add_option("--queries", options.queries, "Query points")->check(CLI::PositiveNumber);
  std::function<std::vector<infer::BenchResult>(const infer::BenchOptions&)> benchmark;
  const auto add = [&](const char* name, const char* help, auto function) {
    CLI::App* command = app.add_subcommand(name, help)->fallthrough();
    command->callback([&benchmark, function] { benchmark = function; });
    return command;
  };
  add("ops", "Every operator alone", infer::bench_ops);
  for (CLI::App* command : {add("encoder", "Scene points to embedding", infer::bench_encoder),
                            add("decoder", "Query points to irradiance", infer::bench_decoder)})
    infer::add_network_options(*command, &options.precision, &options.max_memory_mb);
#if LTE_HAS_SCENE
  CLI::App* pathtrace =
      add("pathtrace", "Path tracing against bare Embree calls", infer::bench_pathtrace);
  CLI::App* pareto =
      add("pareto", "Run time against error, beside path tracing", infer::bench_pareto);
  for (CLI::App* command : {pathtrace, pareto})
    command->add_option("--scene", options.scene, "glTF scene (default: the shipped Cornell box)");
  pareto->add_option("--checkpoint", options.checkpoint, "Model (default: the shipped one)");
  pareto->add_option("--reference-rays", options.reference_rays, "Rays a pixel of the reference");
#endif
  app.require_subcommand(1);
  return infer::run_network_tool(app, argc, argv, [&] {
    apply_common_options(common);
    runtime::set_torch_threads(common.threads);
    const std::vector<infer::BenchResult> results = benchmark(options);
    infer::print_bench_table(results);
    if (!common.json.empty()) write_file(common.json, infer::bench_json(results));
  });
}
