// Where an axis has its ticks.
#pragma once

#include <vector>

namespace lte::experiments {

/// Multiples of 1, 2 or 5 times a power of ten inside [low, high], some five of them. low < high.
std::vector<double> linear_ticks(double low, double high);

/// Ticks of a logarithmic axis from `low` to `high`, 0 < low < high. There are always two or more:
/// whole decades if three of these are inside (every other, every third, ... if they are many),
/// else 1, 2 and 5 of each decade, else those of a linear axis.
std::vector<double> log_ticks(double low, double high);

}  // namespace lte::experiments
