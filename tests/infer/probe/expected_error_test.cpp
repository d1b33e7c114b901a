// What error is expected of gathered light, by hand. That it is made is tested by the tool's table.
#include "infer/probe/expected_error.h"

#include <cmath>

#include <gtest/gtest.h>

namespace lte::infer {
namespace {

Rgb gray(float value) { return {value, value, value}; }

GatheredProbe two_points() {
  GatheredProbe out;
  out.indirect = {gray(10), gray(10)};
  out.standard_error = {gray(0.6f), gray(0)};
  out.tables = 4;
  return out;
}

TEST(ExpectedError, TablesOfOthersSpeakForAPointWhoseOwnAgreeByChance) {
  // Both are as bright, so half of 0.36 is drawn towards at each; its own three degrees count half.
  const std::vector<Rgb> no_direct(2);
  const std::vector<double> errors = expected_errors(two_points(), no_direct, {});
  EXPECT_NEAR(errors[0], std::sqrt((0.36 + 0.18) / 2 + 0.04), 1e-6);
  EXPECT_NEAR(errors[1], std::sqrt(0.18 / 2 + 0.04), 1e-6);
}

TEST(ExpectedError, WhatTheRegionMayBeOffByCountsAndHowFarRegionsAreOff) {
  GatheredProbe exact = two_points();
  exact.standard_error = {gray(0), gray(0)};
  LightCheck check;
  check.regions.resize(2);
  check.regions[0].expected_square = 0.08;
  check.variance = 0.02;
  check.region_of = {0, 1};
  const std::vector<Rgb> direct = {{0.3f, 0, 0}, {0, 0, 0}};
  const std::vector<double> errors = expected_errors(exact, direct, check);
  EXPECT_NEAR(errors[0], std::sqrt((0.08 + 0.02) * 100 + 0.04 + 0.03), 1e-5);
  EXPECT_NEAR(errors[1], std::sqrt(0.02 * 100 + 0.04), 1e-5);
}

TEST(ExpectedError, IsNoneWithoutLight) {
  GatheredProbe dark = two_points();
  dark.indirect = dark.standard_error = {{}, {}};
  for (const double error : expected_errors(dark, dark.indirect, {})) EXPECT_EQ(error, 0);
}

}  // namespace
}  // namespace lte::infer
