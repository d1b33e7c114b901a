// JSON as the logs and results of training have it: keys in the order in which they are added.
#pragma once

#include <nlohmann/json.hpp>

namespace lte::train {

using Json = nlohmann::ordered_json;

}  // namespace lte::train
