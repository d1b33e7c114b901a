// The command line of lte_bench pareto.
#pragma once

#include <string>

#include "bench/pareto/pareto.h"
#include "lte/cli/cli.h"

namespace lte::bench {

struct ParetoRequest {
  ParetoOptions options;
  std::vector<std::string> sizes = {"160x120"};
};

void add_pareto_options(CLI::App& command, ParetoRequest* request);

/// @param repeats  timed runs of a method
void run_pareto(const ParetoRequest& request, int repeats, const CommonOptions& common);

}  // namespace lte::bench
