// lte_bench: times of every stage, and time against error.
#include "infer/bench/bench_command.h"
#include "infer/common/tool_options.h"

int main(int argc, char** argv) {
  CLI::App app{"Measure run time, and run time against error.", "lte_bench"};
  app.footer(
      "Examples:\n  lte_bench decoder --json decoder.json\n  lte_bench pareto --scene room.glb");
  lte::infer::BenchRequest request;
  lte::infer::add_bench_options(app, &request);
  return lte::infer::run_network_tool(app, argc, argv, [&] { lte::infer::run_bench(request); });
}
