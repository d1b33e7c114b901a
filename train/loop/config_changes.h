// What a resumed run changes of the configuration that it had.
#pragma once

#include <string>
#include <vector>

namespace lte::train {

/// Compares two configurations, whole and in YAML, key by key; numbers by value.
/// @return  "train.steps: 6 -> 1000" for each key that differs, in the order of `now` and then of
///          `before`; a key that one of them lacks has its default there
/// @throws lte::Error unless both are maps.
std::vector<std::string> config_changes(const std::string& before, const std::string& now);

}  // namespace lte::train
