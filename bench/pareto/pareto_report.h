// What lte_bench pareto shows: a table for a terminal, JSON, and a page of charts.
#pragma once

#include <string>
#include <vector>

#include "bench/pareto/pareto.h"

namespace lte::bench {

std::string pareto_table(const std::vector<ParetoChart>& charts);
std::string pareto_json(const ParetoOptions& options, const std::vector<ParetoChart>& charts);
std::string pareto_html(const ParetoOptions& options, const std::vector<ParetoChart>& charts);

/// Of each row, the numbers of views (kViewCounts) at which it is on the front of time against the
/// relative MSE of the whole picture.
std::vector<std::vector<int>> fronts_of(const ParetoChart& chart);

}  // namespace lte::bench
