// What lte_bench stability shows: a table for a terminal, JSON, and a page.
#pragma once

#include <string>
#include <vector>

#include "experiments/stability/stability.h"

namespace lte::experiments {

std::string stability_table(const std::vector<StabilityRow>& rows);
std::string stability_json(const StabilityOptions& options, const std::vector<StabilityRow>& rows);
std::string stability_html(const StabilityOptions& options, const std::vector<StabilityRow>& rows);

/// "all 40 rows are finite and within their bounds", or how many are not and which is the first.
std::string stability_verdict(const std::vector<StabilityRow>& rows);
bool all_hold(const std::vector<StabilityRow>& rows);

}  // namespace lte::experiments
