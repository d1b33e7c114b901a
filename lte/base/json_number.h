// Numbers as JSON, which knows no NaN and no infinity.
#pragma once

#include <cmath>

#include <nlohmann/json.hpp>

namespace lte {

/// null for what is not finite.
inline nlohmann::json json_number(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json();
}

}  // namespace lte
