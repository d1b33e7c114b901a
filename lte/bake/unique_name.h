// Internal: names that tell things of one kind apart.
#pragma once

#include <set>
#include <string>

#include "lte/base/check.h"

namespace lte::bake {

/// The name, with a number behind it where it is taken. Takes it.
inline std::string unique_name(const std::string& name, std::set<std::string>* taken) {
  std::string out = name;
  for (int k = 2; !taken->insert(out).second; ++k) out = concat(name, "_", k);
  return out;
}

}  // namespace lte::bake
