// Comparisons that tests of scenes share.
#pragma once

#include <cmath>

#include <gtest/gtest.h>

#include "lte/base/math.h"

namespace lte::test {

inline void expect_near(const Vec3& got, const Vec3& want, float tolerance = 1e-5f) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(got[c], want[c], tolerance) << "component " << c;
}

/// Linear value of an 8-bit code: the sRGB curve of IEC 61966-2-1, written out.
inline double decode_srgb(double code) {
  const double c = code / 255.0;
  return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

}  // namespace lte::test
