// Figures of a method in a scene as JSON; what could not be measured is null.
#pragma once

#include <nlohmann/json.hpp>

#include "infer/eval/scenes/scenes.h"

namespace lte::infer {

nlohmann::json figures_json(const MethodFigures& figures);

/// @throws nlohmann::json::exception
MethodFigures figures_of(const nlohmann::json& json);

}  // namespace lte::infer
