// What lte_bench does between its command line and its exit code.
#pragma once

#include <functional>
#include <vector>

#include "bench/bench.h"
#include "lte/cli/cli.h"

namespace lte::bench {

struct BenchRequest {
  BenchOptions options;
  CommonOptions common;
  /// The benchmark whose subcommand was chosen ...
  std::function<std::vector<BenchResult>(const BenchOptions&)> benchmark;
  /// ... or pareto, which has a result of its own.
  std::function<void()> command;
};

/// Adds the options and a subcommand for each benchmark, which parsing puts into `request`.
void add_bench_options(CLI::App& app, BenchRequest* request);

/// Runs the benchmark or command, prints a table and writes JSON if it is asked for.
void run_bench(const BenchRequest& request);

}  // namespace lte::bench
