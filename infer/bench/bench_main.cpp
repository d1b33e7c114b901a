// lte_bench: times of every stage, time against error, and the stress of numbers.
#include "infer/bench/bench_command.h"
#include "infer/tool/tool_options.h"

int main(int argc, char** argv) {
  CLI::App app{"Measure run time, run time against error, and numerical stability.", "lte_bench"};
  app.footer(
      "Examples:\n  lte_bench decoder --json decoder.json\n  lte_bench pareto room.glb --out "
      "pareto.html\n  lte_bench stability --quick");
  lte::infer::BenchRequest request;
  lte::infer::add_bench_options(app, &request);
  return lte::infer::run_network_tool(app, argc, argv, [&] { lte::infer::run_bench(request); });
}
