// Seconds by stage, for people and as JSON.
#pragma once

#include <nlohmann/json.hpp>

#include "infer/renderer/renderer.h"

namespace lte::infer {

nlohmann::json seconds_json(const StageSeconds& seconds, double total);

/// Adds the stages that each picture has of its own.
void add_seconds(const StageSeconds& picture, StageSeconds* sum);

/// Ends a line on standard output.
void print_times(const StageSeconds& seconds, double total);

}  // namespace lte::infer
