// Light on both sides of surface points by many paths, with its variance: what light estimates are
// held against, point by point.
#pragma once

#include <cmath>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "lte/pathtrace/irradiance.h"

namespace lte::test {

/// One quantity at some points: the sum over light groups, and the variance of that sum, averaged
/// over color channels.
struct Measured {
  std::vector<Rgb> value;
  std::vector<double> variance;
};

struct TwoSidedLight {
  Measured direct, indirect;
};

/// E(n) + E(−n) at each point from `options.rays` paths a side.
inline TwoSidedLight two_sided_light(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                                     std::span<const Vec3> positions, std::span<const Vec3> normals,
                                     pathtrace::IrradianceOptions options) {
  const size_t count = positions.size();
  std::vector<Vec3> reversed;
  for (const Vec3& n : normals) reversed.push_back(-n);
  TwoSidedLight out;
  for (Measured* m : {&out.direct, &out.indirect}) {
    m->value.resize(count);
    m->variance.resize(count);
  }
  for (const std::span<const Vec3> side : {normals, std::span<const Vec3>(reversed)}) {
    ++options.seed;
    options.direct_only = false;
    const auto all = pathtrace::estimate_irradiance(bvh, lights, positions, side, options);
    options.direct_only = true;  // whose total is the direct light, and so is its variance
    const auto direct = pathtrace::estimate_irradiance(bvh, lights, positions, side, options);
    for (size_t i = 0; i < count; ++i) {
      const auto point = static_cast<int64_t>(i);
      const Rgb& v = direct.variance_total[i];
      out.direct.value[i] += direct.direct_sum(point);
      out.direct.variance[i] += (v.x + v.y + v.z) / 3;
      out.indirect.value[i] += all.indirect_sum(point);
      out.indirect.variance[i] += all.variance[i];
    }
  }
  return out;
}

/// Expects each of `got` within five standard errors of the reference and 1 % of the mean over
/// points, and all together within one and a half standard errors in the root mean square; and that
/// such errors are small beside the values.
/// @param own  what `got` may be off by: of as many paths as it was made with
inline void expect_within_error(const std::vector<Rgb>& got, const Measured& own,
                                const Measured& reference, const std::string& what) {
  ASSERT_EQ(got.size(), reference.value.size());
  double squares = 0, variances = 0, values = 0;
  int lit = 0;
  const auto count = static_cast<double>(got.size());
  for (const Rgb& v : reference.value) values += (v.x + v.y + v.z) / 3;
  // Where next to no path finds light, the variance is known badly.
  const double slack = 0.01 * values / count;
  for (size_t i = 0; i < got.size(); ++i) {
    const double variance = own.variance[i] + reference.variance[i];
    const Rgb d = got[i] - reference.value[i];
    const double square = dot(d, d) / 3;
    EXPECT_LE(square, 25 * variance + slack * slack)
        << what << " at point " << i << ": " << got[i].x << " for " << reference.value[i].x;
    variances += variance;
    if (variance > 0) {
      squares += square / variance;
      ++lit;
    }
  }
  ASSERT_GT(lit, 0) << what;
  EXPECT_LT(squares / lit, 1.5 * 1.5) << what;
  EXPECT_LT(std::sqrt(variances / count), 0.05 * values / count) << what << ": too noisy a test";
}

}  // namespace lte::test
