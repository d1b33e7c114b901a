// JSON as the logs and results of training have it: keys in the order in which they are added.
#pragma once

#include <cmath>

#include <nlohmann/json.hpp>

namespace lte::train {

using Json = nlohmann::ordered_json;

/// JSON knows no NaN and no infinity.
inline Json number_or_null(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

}  // namespace lte::train
