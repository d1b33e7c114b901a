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
  // Both are as bright, so half of 0.36 is drawn towards at each; its own have three degrees of
  // freedom, those of all count as one. The unit is 11.
  const std::vector<Rgb> no_direct(2);
  const double shared = std::pow(11 * gi::kSharedError, 2);
  const std::vector<double> errors = expected_errors(two_points(), no_direct, {});
  EXPECT_NEAR(errors[0], std::sqrt((3 * 0.36 + 0.18) / 4 + shared), 1e-6);
  EXPECT_NEAR(errors[1], std::sqrt(0.18 / 4 + shared), 1e-6);
}

TEST(ExpectedError, DarkPointsHaveErrorsOfTheLightAround) {
  GatheredProbe light = two_points();
  light.indirect = {gray(19.8f), gray(0.2f)};
  light.standard_error = {gray(0), gray(0)};
  const std::vector<Rgb> no_direct(2);
  EXPECT_NEAR(expected_errors(light, no_direct, {})[1], 1.2 * gi::kSharedError, 1e-6);
}

TEST(ExpectedError, WhatTheRegionMayBeOffByCounts) {
  GatheredProbe exact = two_points();
  exact.standard_error = {gray(0), gray(0)};
  LightCheck check;
  check.regions.resize(2);
  check.regions[0].expected_square = 0.08;
  check.regions[1].expected_square = 0.02;
  check.region_of = {0, 1};
  const std::vector<Rgb> direct = {{0.3f, 0, 0}, {0, 0, 0}};
  const std::vector<double> errors = expected_errors(exact, direct, check);
  EXPECT_NEAR(errors[0], std::sqrt(0.08 * 121 + 0.03), 1e-5);
  EXPECT_NEAR(errors[1], std::sqrt(0.02 * 121), 1e-5);
}

TEST(ExpectedError, IsNoneWithoutLight) {
  GatheredProbe dark = two_points();
  dark.indirect = dark.standard_error = {{}, {}};
  for (const double error : expected_errors(dark, dark.indirect, {})) EXPECT_EQ(error, 0);
}

}  // namespace
}  // namespace lte::infer
