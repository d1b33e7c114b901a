// Homes that are made quickly, for tests.
#pragma once

#include "datagen/homes/home.h"

namespace lte::datagen::homes {

inline HomeConfig coarse() {
  HomeConfig config;
  config.texture_sizes = {8};  // what these tests look at depends neither on texels
  config.detail = {0.3, 0.3};  // nor, but for the budget, on the fineness of curves
  return config;
}

}  // namespace lte::datagen::homes
