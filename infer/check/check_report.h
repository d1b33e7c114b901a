// What a check of light has found, for people and as JSON.
#pragma once

#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "infer/check/light_check.h"

namespace lte::infer {

/// The line to warn with, or nothing if there is no cause.
/// @param who    whose light it is: "the network's", "the gathered"
/// @param where  what the places are parts of: "the picture", "the points"
std::string check_note(const LightCheck& check, std::string_view who, std::string_view where);

/// All ratios; false where nothing was compared.
nlohmann::json check_json(const LightCheck& check);

}  // namespace lte::infer
