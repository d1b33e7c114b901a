// The command line of lte_bench pareto.
#pragma once

#include <string>

#include "infer/bench/pareto/pareto.h"
#include "lte/cli/cli.h"

namespace lte::infer {

struct ParetoRequest {
  ParetoOptions options;
  std::vector<std::string> sizes = {"160x120"};
  std::string cache;  ///< --reference-cache; empty: beside `out`
  std::string out;    ///< the page; empty: none
};

void add_pareto_options(CLI::App& command, ParetoRequest* request);

void run_pareto(const ParetoRequest& request, const CommonOptions& common);

}  // namespace lte::infer
