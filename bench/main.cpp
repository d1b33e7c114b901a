// lte_bench: times of every stage, and time against error.
#include "bench/bench_command.h"
#include "infer/tool/tool_options.h"

int main(int argc, char** argv) {
  CLI::App app{"Measure run time, and run time against error.", "lte_bench"};
  app.footer(
      "Examples:\n  lte_bench decoder --json decoder.json\n  lte_bench pareto room.glb --json "
      "pareto.json");
  lte::bench::BenchRequest request;
  lte::bench::add_bench_options(app, &request);
  return lte::infer::run_network_tool(app, argc, argv, [&] { lte::bench::run_bench(request); });
}
