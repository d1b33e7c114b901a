// Sums over light groups: transport is linear in emission, so the light of a scene is the sum of
// its luminaires' light.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "lte/base/half.h"
#include "lte/base/math.h"

namespace lte::data {

/// @param values  [G, N] values of each group, G-major.
/// @param groups  G; divides the number of values.
/// @param factor  what the sums are multiplied by.
/// @return        [N] float32 sums over the groups; empty without groups.
std::vector<Rgb> sum_groups(std::span<const Rgb> values, int64_t groups, double factor);

std::vector<float> to_floats(std::span<const Half> values);

/// The standard error of a sum of light of several groups, as if their errors were independent: the
/// paths that estimate them pick one light at each vertex, so they nearly are.
class ErrorOfSum {
 public:
  /// @param error  standard error of the group's `light`, of the mean over its channels, over that
  ///               mean: a tint or a gain leaves it as it is
  void add(float error, const Rgb& light) {
    const double gray = (double{light.x} + light.y + light.z) / 3;
    mean_ += gray;
    variance_ += error * gray * (error * gray);
  }
  /// Over the mean of the sum: in [0, 1] if all that were added are; 0 without light.
  float relative() const {
    return mean_ > 0 ? static_cast<float>(std::sqrt(variance_) / mean_) : 0.0f;
  }

 private:
  double mean_ = 0, variance_ = 0;
};

/// Light on scene points by group, G-major; each may be empty.
struct GroupedLight {
  std::span<const Rgb> direct = {}, indirect = {};            ///< [G, M], on both sides together
  std::span<const Rgb> direct_back = {}, indirect_back = {};  ///< [G, M], of these
  std::span<const float> error = {}, error_back = {};         ///< [G, M], of indirect; relative
};

/// The sum of it over the groups, each [M], what was empty still so.
struct PointIrradiance {
  std::vector<Rgb> direct, indirect, direct_back, indirect_back;
  std::vector<float> error;  ///< [M, 2], front and back
};

PointIrradiance sum_groups(const GroupedLight& light, int64_t groups);

}  // namespace lte::data
