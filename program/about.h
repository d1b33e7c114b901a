// What a program lte is and has: for people who ask why, and for reports.
#pragma once

#include <nlohmann/json.hpp>

#include "program/commands.h"

namespace lte {

/// {"version", "instruction_set", "threads", "scenes", "pictures", "models": {name: file},
/// "denoiser", "torch": the program that trains and exports, or null}.
nlohmann::ordered_json about(const TorchTools& torch);

}  // namespace lte
