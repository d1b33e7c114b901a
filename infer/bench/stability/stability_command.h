// The command line of lte_bench stability.
#pragma once

#include <string>

#include "infer/bench/stability/stability.h"
#include "lte/cli/cli.h"

namespace lte::infer {

struct StabilityRequest {
  StabilityOptions options;
  std::string out;  ///< the page; empty: none
};

void add_stability_options(CLI::App& command, StabilityRequest* request);

/// @throws lte::Error that names the first row to break its bound, after all has been written.
void run_stability(const StabilityRequest& request, const CommonOptions& common);

}  // namespace lte::infer
