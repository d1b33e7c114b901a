// What lte_probe does between its command line and its exit code.
#pragma once

#include <cstdint>
#include <string>

#include "infer/renderer/light_request.h"

namespace lte::infer {

/// The command line as it stands.
struct ProbeRequest : LightRequest {
  std::string points, out;
  int64_t spp = 0;   ///< 0: as many as suit the integrator
  double error = 0;  ///< relative standard error that paths are to reach; 0: none
  bool check = true;
};

void add_probe_options(CLI::App& app, ProbeRequest* request);

/// Loads, computes, writes the table, and prints a line.
/// @throws lte::Error for bad input, also for flags that would be ignored.
void run_probe(const ProbeRequest& request);

}  // namespace lte::infer
