// Sums over light groups: transport is linear in emission, so the light of a scene is the sum of
// its luminaires' light.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lte/base/math.h"

namespace lte::data {

/// @param values  [G, N] values of each group, G-major.
/// @param groups  G; divides the number of values.
/// @param factor  what the sums are multiplied by.
/// @return        [N] float32 sums over the groups; empty without groups.
std::vector<Rgb> sum_groups(std::span<const Rgb> values, int64_t groups, double factor);

}  // namespace lte::data
