// What lte_bench pareto shows: a table for a terminal, and JSON.
#pragma once

#include <string>
#include <vector>

#include "bench/pareto/pareto.h"

namespace lte::bench {

std::string pareto_table(const std::vector<ParetoChart>& charts);
std::string pareto_json(const ParetoOptions& options, const std::vector<ParetoChart>& charts);

}  // namespace lte::bench
