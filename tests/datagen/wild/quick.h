// Wild scenes that are made quickly, for tests.
#pragma once

#include "datagen/wild/wild.h"

namespace lte::datagen::wild {

inline WildConfig quick() {
  WildConfig config;
  config.texture_sizes = {8};
  config.detail = {0.3, 0.3};
  return config;
}

}  // namespace lte::datagen::wild
